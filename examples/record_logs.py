"""Logs of a MuJoCo robot that is not quite as designed: on the best motion, on another one, and
with 2 kg on the platform. The program's example logs are made by this script."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from paminsa_viz.actuation import actuator_limits
from paminsa_viz.engines import LogNoise, simulate_log
from paminsa_viz.files import DataTable, provenance, table_csv
from paminsa_viz.identification import ExcitationLimits, ExcitationSettings, optimize_excitation
from paminsa_viz.model import APPENDIX_4, Friction, Payload

RATE = 250.0

built = APPENDIX_4.vary({"links.b4": 1.2 * APPENDIX_4.value("links.b4"), "joints.j9": 0.25})
built = replace(built, friction=Friction(0.5, 0.7, 30.0, 6.0), name="built robot")
limits = actuator_limits(APPENDIX_4)
limits = ExcitationLimits(limits.speed, limits.rated)


def motion(evaluations: int, seed: int):
    settings = ExcitationSettings(evaluations=evaluations, seconds=600.0, seed=seed)
    found = optimize_excitation(APPENDIX_4, limits, settings)
    print(f"seed {seed}: log det {found.log_det:.0f}, {found.gain:.0f} above random motions")
    return found.plan.sample(RATE)


def record(name: str, robot, trajectory, seed: int) -> None:
    log = simulate_log(robot, trajectory, rate=RATE, noise=LogNoise(), seed=seed)
    angles, torques = np.degrees(log.position[:, :3]).round(2), log.torque.round(3)
    columns = {"t_s": log.t.round(4)}
    columns |= {f"theta{j}_deg": angles[:, j - 1] for j in (1, 2, 3)}
    columns |= {"Z_mm": (1e3 * log.position[:, 3]).round(2)}
    columns |= {f"torque{j}_Nm": torques[:, j - 1] for j in (1, 2, 3)}
    columns |= {"force4_N": torques[:, 3]}
    facts = {"robot": robot.name, "made with": "MuJoCo, examples/record_logs.py"}
    Path(name).write_bytes(table_csv(DataTable(columns, provenance("paminsa_viz log 1", facts))))


best = motion(400, 0)
record("example_log.csv", built, best, 1)
record("example_log_other.csv", built, motion(0, 5), 2)
record("example_log_payload.csv", replace(built, payload=Payload(2.0)), best, 3)
