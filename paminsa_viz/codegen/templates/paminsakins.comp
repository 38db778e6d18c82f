component paminsakins "Kinematics of the PAMINSA, four joints";

description """
Joints 0 to 2 are the rotary actuators theta_1 to theta_3 [degrees], joint 3 is the lift Z [mm]. The
world's X, Y and Z [mm] are the platform's center, C [degrees] its turn about the vertical; A, B, U,
V and W stay zero. The design is that of design.h beside this file.

Build and install it in the folder that it is in, with paminsa.h and design.h:

    sudo halcompile --install paminsakins.comp

In the INI file:

    [KINS]
    KINEMATICS = paminsakins
    JOINTS = 4

    [TRAJ]
    COORDINATES = X Y Z C
    LINEAR_UNITS = mm
    ANGULAR_UNITS = degree

JOINT_0 to JOINT_2 are of TYPE = ANGULAR, JOINT_3 is LINEAR; their limits, speeds and scales are the
machine's. X, Y, Z and C can be commanded once all four are homed: HOME_OFFSET is where a joint is,
by the conventions of README.md, when its home switch closes.

For a machine in inches set UNITS_PER_METER below. Forward kinematics has up to two solutions; it
takes the one nearest to the position that LinuxCNC had before. Where a pose cannot be reached, or
joints have no pose, the functions fail and LinuxCNC stops the motion.
""";

pin out bit is_module = 1 "halcompile wants a pin";

license "Dual MIT/GPL";
;;

#include "rtapi_math.h"
#include "kinematics.h"
#include "paminsa.h"
#include "design.h"

#define UNITS_PER_METER 1000.0
#define DEGREES_PER_RADIAN 57.295779513082320877

#ifdef KINS_NOT_SWITCHABLE
KINS_NOT_SWITCHABLE
#endif
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);

KINEMATICS_TYPE kinematicsType(void)
{
    return KINEMATICS_BOTH;
}

int kinematicsForward(const double *joints, EmcPose *pos, const KINEMATICS_FORWARD_FLAGS *fflags,
    KINEMATICS_INVERSE_FLAGS *iflags)
{
    double actuators[4], near[4], pose[4];

    (void)fflags;
    (void)iflags;
    for (int i = 0; i < 3; i++)
        actuators[i] = joints[i] / DEGREES_PER_RADIAN;
    actuators[3] = joints[3] / UNITS_PER_METER;
    near[0] = pos->tran.x / UNITS_PER_METER;
    near[1] = pos->tran.y / UNITS_PER_METER;
    near[2] = pos->c / DEGREES_PER_RADIAN;
    near[3] = pos->tran.z / UNITS_PER_METER;
    if (paminsa_nearest_pose(&PAMINSA_DESIGN, actuators, near, pose) != PAMINSA_STATUS_OK)
        return -1;
    pos->tran.x = pose[0] * UNITS_PER_METER;
    pos->tran.y = pose[1] * UNITS_PER_METER;
    pos->tran.z = pose[3] * UNITS_PER_METER;
    pos->c = pose[2] * DEGREES_PER_RADIAN;
    pos->a = pos->b = pos->u = pos->v = pos->w = 0.0;
    return 0;
}

int kinematicsInverse(const EmcPose *pos, double *joints, const KINEMATICS_INVERSE_FLAGS *iflags,
    KINEMATICS_FORWARD_FLAGS *fflags)
{
    const double pose[4] = {
        pos->tran.x / UNITS_PER_METER, pos->tran.y / UNITS_PER_METER,
        pos->c / DEGREES_PER_RADIAN, pos->tran.z / UNITS_PER_METER
    };
    double actuators[4];

    (void)iflags;
    (void)fflags;
    if (paminsa_inverse_kinematics(&PAMINSA_DESIGN, pose, actuators).status != PAMINSA_STATUS_OK)
        return -1;
    for (int i = 0; i < 3; i++)
        joints[i] = actuators[i] * DEGREES_PER_RADIAN;
    joints[3] = actuators[3] * UNITS_PER_METER;
    return 0;
}
