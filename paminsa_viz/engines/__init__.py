"""The same robot in physics engines written by others, to check the model against.

The robot is described once as a tree of links with loop closures (`mechanism`), and each engine
builds its own model from that: MuJoCo from an MJCF text (`mjcf`, `mujoco_model`), Pinocchio joint
by joint (`pinocchio_model`). Mass matrices, bias forces and constraint Jacobians are the engines'
own; `closed_loop` only eliminates the dependent joints, and `simulation` lets MuJoCo run. From the
model come the design and where the joints stand at a pose (`placing`), which the closures verify;
nothing of its statics and dynamics is used.

The engines are optional: ``pip install 'paminsa-viz[verify]'``.
"""
