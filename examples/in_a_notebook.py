# %% [markdown]
# The robot, its maps and its motions inside a notebook. Open this file in Jupyter (with jupytext),
# VS Code or PyCharm, where each `# %%` begins a cell; as a script it writes the same to files.

# %%
from paminsa_viz import APPENDIX_4, analyze
from paminsa_viz.notebook import curve_view, map_view, motion_view, robot_view
from paminsa_viz.trajectory import PRESET

# %% The robot in a pose, to be turned and zoomed: x, y, theta, z in meters and radians
robot = robot_view(APPENDIX_4, (0.05, -0.03, 0.4, -0.6))
robot

# %% Torque maps with values under the mouse
maps = map_view(APPENDIX_4, (0.05, -0.03, 0.4, -0.6))
maps

# %% A motion: played in 3D, and its torques
motion = PRESET["arch"].build(APPENDIX_4.geometry).sample()
player = motion_view(motion)
player

# %%
curves = curve_view(analyze(APPENDIX_4, motion))
curves

# %% What is shown can be kept
robot.save("robot.html")
maps.write_html("maps.html")
player.save("motion.html")
curves.save("torques.svg")
