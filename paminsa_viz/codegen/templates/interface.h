/* ------------------------------------------------------------------------------------------------
 * The robot
 *
 * A pose is (x, y, theta, z) [m, m, rad, m] in the base frame: origin in the plane of the guides on
 * the robot's axis, z up. Actuator positions are (theta_1, theta_2, theta_3, Z) [rad, rad, rad, m],
 * their torques (tau_1, tau_2, tau_3, F_4) [N m, N m, N m, N], positive along the positions.
 *
 * Every function that can fail returns a status and then leaves NaN in all of its outputs. None
 * allocates memory, keeps anything, or reads anything but its arguments, so that all may be called
 * from several threads. Outputs may not overlap inputs.
 * ---------------------------------------------------------------------------------------------- */

/* Why a pose cannot be taken, or a result not be given. */
typedef enum {
    PAMINSA_STATUS_OK = 0,         /* all is well */
    PAMINSA_STATUS_NOT_FINITE = 1, /* an argument is not finite */
    PAMINSA_STATUS_STRETCHED = 2,  /* joints 8 and 5 of a leg are too far apart for its bars */
    PAMINSA_STATUS_FOLDED = 3,     /* joints 8 and 5 of a leg are too close together for its bars */
    PAMINSA_STATUS_GUIDE = 4,      /* joint 8 of a leg would leave its guide */
    PAMINSA_STATUS_AXIS = 5,       /* joint 5 of a leg is on its leg axis */
    PAMINSA_STATUS_SINGULAR = 6,   /* nothing holds the platform there, or resists its motion */
    PAMINSA_STATUS_NO_ASSEMBLY = 7 /* no pose has these actuator positions */
} PaminsaStatus;

/* Whether a pose can be taken. */
typedef struct {
    PaminsaStatus status;
    int leg;        /* the leg that is the reason, 1 to 3; 0 for none */
    double margin;  /* distance to the nearest limit, negative beyond it [m] */
} PaminsaReach;

/* How far a pose is from singular ones. */
typedef struct {
    double determinant;        /* zero at a type-2 singularity [m] */
    double condition;          /* of the Jacobian with R_pl as length; infinite at type 2 */
    double position_distance;  /* to the singular circle at this theta, positive inside [m] */
    double rotation_distance;  /* to the nearest singular theta, positive before it [rad] */
    double serial_distance;    /* to a leg stretched, folded or on its axis, type 1 [m] */
} PaminsaSingularity;

/* A robot. A copy may be changed while a program runs, and there may be several. */
typedef struct {
    PaminsaMechanism mechanism;  /* lengths, see paminsa_mechanism_of_lengths */
    PaminsaEnergyTerms energy;   /* masses, see paminsa_set_payload */
    double platform_mass;        /* without payload [kg] */
    double platform_inertia;     /* without payload, about the vertical [kg m^2] */
    double gravity;              /* [m/s^2] */
    double viscous[4];           /* friction of M1..M4, drives included [N m s/rad, N s/m] */
    double coulomb[4];           /* [N m, N] */
    double transition_speed;     /* of the Coulomb friction's smooth step [rad/s, m/s] */
    double drive_inertia[4];     /* of rotors and gears at the actuators [kg m^2, kg] */
    double force[3];             /* external force on the platform [N] */
    double moment[3];            /* external moment on the platform [N m] */
    double point[3];             /* where the force acts, in the platform's frame [m] */
    double load_turns;           /* 1: force and moment turn with the platform, 0: they do not */
} PaminsaDesign;

/* A function with all that it calls in one piece, which compilers need to vectorize its loop. */
#if defined __GNUC__ && !defined __clang__
#define PAMINSA_FLAT __attribute__((flatten))
#else
#define PAMINSA_FLAT
#endif

#if defined _MSC_VER /* its C has the keyword only from /std:c11 on */
#define PAMINSA_RESTRICT __restrict
#elif defined __cplusplus
#define PAMINSA_RESTRICT
#else
#define PAMINSA_RESTRICT restrict
#endif

/* beta_k at theta_k = 0 [rad] (Appendix 1). */
static const double PAMINSA_HEADING[3] = {@HEADING@};

/* Change the payload: its mass [kg], and its inertia about the vertical [kg m^2] (Eqs. 11-14). */
static inline void paminsa_set_payload(PaminsaDesign *design, double mass, double inertia)
{
    design->energy.mass = design->platform_mass + mass;
    design->energy.inertia = design->platform_inertia + inertia;
}

/* Helper, not in the paper, no unit: set all values. */
static inline void paminsa_fill(double *values, int count, double value)
{
    for (int i = 0; i < count; i++)
        values[i] = value;
}

/* Helper, not in the paper, no unit: set all entries. */
static inline void paminsa_fill_matrix(double matrix[4][4], double value)
{
    for (int row = 0; row < 4; row++)
        paminsa_fill(matrix[row], 4, value);
}

/* Helper, not in the paper, no unit: whether all values are finite. */
static inline int paminsa_finite(const double *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return 0;
    return 1;
}

/* Say whether a pose [m, m, rad, m] can be taken, and if not, which leg and which limit forbid it.
 *
 * Appendix 1 has no real solution beyond the limits of the bars; the others are not in the paper.
 */
static inline PaminsaReach paminsa_reach(const PaminsaDesign *design, const double pose[4])
{
    static const PaminsaStatus limits[4] = {
        PAMINSA_STATUS_STRETCHED, PAMINSA_STATUS_FOLDED,
        PAMINSA_STATUS_GUIDE, PAMINSA_STATUS_AXIS
    };
    PaminsaReach reach = {PAMINSA_STATUS_NOT_FINITE, 0, NAN};

    if (!paminsa_finite(pose, 4))
        return reach;
    const PaminsaLeastMargin least = paminsa_least_margin(
        &design->mechanism, pose[0], pose[1], cos(pose[2]), sin(pose[2]), pose[3]);
    if (!isfinite(least.margin))
        return reach;
    const int which = (int)least.which;
    const int on_guide = which % 4 == 2;
    reach.status = PAMINSA_STATUS_OK;
    reach.margin = least.margin;
    /* A guide may be used to its end; at the other limits the mechanism is singular. */
    if (least.margin < 0.0 || (least.margin == 0.0 && !on_guide)) {
        reach.status = limits[which % 4];
        reach.leg = which / 4 + 1;
    }
    return reach;
}

/* Give the distances of each leg to its limits, negative beyond them [m]; not in the paper.
 *
 * margins[leg] is: l_B4 + l_B8 - |85|; |85| - |l_B4 - l_B8|; stroke - |X_4|; X_1 - clearance.
 */
static inline void paminsa_margins(const PaminsaDesign *design, const double pose[4],
    double margins[3][4])
{
    const double c = cos(pose[2]), s = sin(pose[2]);

    for (int leg = 0; leg < 3; leg++) {
        const PaminsaLegMargins found = paminsa_leg_margins(&design->mechanism,
            PAMINSA_AXIS_X[leg], PAMINSA_AXIS_Y[leg], pose[0], pose[1], c, s, pose[3]);
        margins[leg][0] = found.stretch;
        margins[leg][1] = found.fold;
        margins[leg][2] = found.guide;
        margins[leg][3] = found.axis;
    }
}

/* Give the actuator positions of a pose (Appendix 1) [rad, rad, rad, m]. */
static inline PaminsaReach paminsa_inverse_kinematics(const PaminsaDesign *design,
    const double pose[4], double actuators[4])
{
    const PaminsaReach reach = paminsa_reach(design, pose);

    paminsa_fill(actuators, 4, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    const double c = cos(pose[2]), s = sin(pose[2]);
    for (int leg = 0; leg < 3; leg++) {
        const PaminsaLegPosition position = paminsa_leg_position(&design->mechanism,
            PAMINSA_AXIS_X[leg], PAMINSA_AXIS_Y[leg], pose[0], pose[1], c, s, pose[3]);
        actuators[leg] = paminsa_leg_angles(&position, PAMINSA_HEADING[leg]).theta;
    }
    actuators[3] = paminsa_lift_position(&design->mechanism, pose[3]);
    return reach;
}

/* Give all poses [m, m, rad, m] of actuator positions [rad, rad, rad, m] (Eqs. 16 and 17), and
 * return their number, 0 to 2.
 *
 * These are the assembly modes in which every leg points from its axis to the platform. Limits of
 * the legs are not looked at; see paminsa_reach. Rows of poses that are not used are NaN.
 */
static inline int paminsa_forward_kinematics(const PaminsaDesign *design,
    const double actuators[4], double poses[2][4])
{
    int count = 0;
    double c[3], s[3];

    paminsa_fill(poses[0], 4, NAN);
    paminsa_fill(poses[1], 4, NAN);
    if (!paminsa_finite(actuators, 4))
        return 0;
    for (int leg = 0; leg < 3; leg++) {
        c[leg] = cos(actuators[leg] + PAMINSA_HEADING[leg]);
        s[leg] = sin(actuators[leg] + PAMINSA_HEADING[leg]);
    }
    for (int branch = 1; branch >= -1; branch -= 2) {
        const PaminsaAssembly found = paminsa_assembly_mode(&design->mechanism,
            c[0], s[0], c[1], s[1], c[2], s[2], branch > 0 ? 1.0 : -1.0);
        if (!(found.along > 0.0) || !isfinite(found.x) || !isfinite(found.y))
            continue;
        poses[count][0] = found.x;
        poses[count][1] = found.y;
        poses[count][2] = paminsa_wrap_angle(atan2(found.s, found.c));
        poses[count][3] = paminsa_platform_height(&design->mechanism, actuators[3]);
        count++;
    }
    return count;
}

/* Give the pose [m, m, rad, m] of actuator positions nearest to a given one (Eqs. 16 and 17).
 *
 * The distance is taken in x, y and R_pl times theta; theta is within half a turn of the given one.
 * For a controller, give the pose of the cycle before.
 */
static inline PaminsaStatus paminsa_nearest_pose(const PaminsaDesign *design,
    const double actuators[4], const double near[4], double pose[4])
{
    double poses[2][4];
    double best = INFINITY;
    const int count = paminsa_forward_kinematics(design, actuators, poses);

    paminsa_fill(pose, 4, NAN);
    if (!paminsa_finite(actuators, 4) || !paminsa_finite(near, 4))
        return PAMINSA_STATUS_NOT_FINITE;
    for (int i = 0; i < count; i++) {
        const double turn = paminsa_wrap_angle(poses[i][2] - near[2]);
        const double path = design->mechanism.platform_radius * turn;
        const double distance = hypot(hypot(poses[i][0] - near[0], poses[i][1] - near[1]), path);
        if (distance < best) {
            best = distance;
            pose[0] = poses[i][0];
            pose[1] = poses[i][1];
            pose[2] = near[2] + turn;
            pose[3] = poses[i][3];
        }
    }
    return best < INFINITY ? PAMINSA_STATUS_OK : PAMINSA_STATUS_NO_ASSEMBLY;
}

/* Helper, not in the paper, units as of the values: put the 9 values of a matrix's part in x, y and
 * theta, and that of z, into four rows.
 */
static inline void paminsa_matrix(const double values[9], double last, double matrix[4][4])
{
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            matrix[row][column] = row < 3 && column < 3 ? values[3 * row + column] : 0.0;
    matrix[3][3] = last;
}

/* Give G with (theta_1', theta_2', theta_3', Z') = G (x', y', theta', z'): Eqs. 16 and 17 derived
 * by time. Rows of M1 to M3 are in [rad/m, rad/m, 1, rad/m], the last one has no unit.
 */
static inline PaminsaReach paminsa_inverse_jacobian(const PaminsaDesign *design,
    const double pose[4], double g[4][4])
{
    const PaminsaMechanism *m = &design->mechanism;
    const PaminsaReach reach = paminsa_reach(design, pose);

    paminsa_fill_matrix(g, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    const PaminsaSpeedRows rows =
        paminsa_speed_rows(m, pose[0], pose[1], cos(pose[2]), sin(pose[2]), pose[3]);
    paminsa_matrix(rows.values, m->inverse_k, g);
    return reach;
}

/* Give J, the inverse of G: (x', y', theta', z') = J (theta_1', theta_2', theta_3', Z') (Eq. 3), in
 * [m/rad] where a length follows an angle.
 */
static inline PaminsaReach paminsa_jacobian(const PaminsaDesign *design, const double pose[4],
    double j[4][4])
{
    const PaminsaMechanism *m = &design->mechanism;
    PaminsaReach reach = paminsa_reach(design, pose);

    paminsa_fill_matrix(j, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    const PaminsaWrenchTorques rows =
        paminsa_wrench_torques(m, pose[0], pose[1], cos(pose[2]), sin(pose[2]), pose[3]);
    if (paminsa_finite(rows.values, 9))
        paminsa_matrix(rows.values, m->k, j);
    else
        reach.status = PAMINSA_STATUS_SINGULAR;
    return reach;
}

/* Give speeds and accelerations of the actuators for a motion of the platform, G v and
 * G a + (dG/dt) v [rad/s, m/s], [rad/s^2, m/s^2] (Eqs. 16 and 17 derived by time).
 */
static inline PaminsaReach paminsa_actuator_motion(const PaminsaDesign *design,
    const double pose[4], const double velocity[4], const double acceleration[4],
    double speed[4], double growth[4])
{
    const PaminsaMechanism *m = &design->mechanism;
    double g[4][4], rate[4][4];
    PaminsaReach reach = paminsa_inverse_jacobian(design, pose, g);

    paminsa_fill(speed, 4, NAN);
    paminsa_fill(growth, 4, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    const PaminsaSpeedRowRates rates = paminsa_speed_row_rates(m, pose[0], pose[1], cos(pose[2]),
        sin(pose[2]), velocity[0], velocity[1], velocity[2]);
    paminsa_matrix(rates.values, 0.0, rate);
    for (int row = 0; row < 4; row++) {
        speed[row] = growth[row] = 0.0;
        for (int i = 0; i < 4; i++) {
            speed[row] += g[row][i] * velocity[i];
            growth[row] += g[row][i] * acceleration[i] + rate[row][i] * velocity[i];
        }
    }
    return reach;
}

/* Give the friction of the actuators at their speeds [N m, N]; not in the paper.
 *
 * It is viscous w + coulomb tanh(w / transition_speed), joints and drives together.
 */
static inline void paminsa_friction_torques(const PaminsaDesign *design, const double speed[4],
    double torque[4])
{
    for (int i = 0; i < 4; i++)
        torque[i] = paminsa_friction(
            design->viscous[i], design->coulomb[i], design->transition_speed, speed[i]);
}

/* Give what accelerates the drives' own inertia, N^2 J times the actuators' accelerations [N m, N];
 * not in the paper.
 */
static inline void paminsa_drive_torques(const PaminsaDesign *design, const double growth[4],
    double torque[4])
{
    for (int i = 0; i < 4; i++)
        torque[i] = design->drive_inertia[i] * growth[i];
}

/* Give the load as a force in x, y, theta, z [N, N, N m, N]; c and s are cos and sin theta. Not in
 * the paper.
 */
static inline void paminsa_load_force(const PaminsaDesign *design, double c, double s,
    double force[4])
{
    const PaminsaDesign *d = design;
    const PaminsaWrenchAtCenter w = paminsa_wrench_at_center(d->force[0], d->force[1],
        d->force[2], d->moment[0], d->moment[1], d->moment[2], d->point[0], d->point[1],
        d->point[2], d->load_turns, c, s);

    force[0] = w.values[0];
    force[1] = w.values[1];
    force[2] = w.values[5];
    force[3] = w.values[2];
}

/* Subtract from torques [N m, N] what the load does to them, J^T w (virtual work, J of Eq. 3). */
static inline PaminsaReach paminsa_subtract_load(const PaminsaDesign *design,
    const double pose[4], PaminsaReach reach, double torque[4])
{
    double force[4], j[4][4];

    paminsa_load_force(design, cos(pose[2]), sin(pose[2]), force);
    if (force[0] == 0.0 && force[1] == 0.0 && force[2] == 0.0 && force[3] == 0.0)
        return reach;
    reach = paminsa_jacobian(design, pose, j);
    for (int i = 0; i < 4; i++)
        for (int row = 0; row < 4; row++)
            torque[i] -= j[row][i] * force[row];
    return reach;
}

/* Give what the weights alone ask of the actuators, dV/dq (Eqs. 1-6, Appendix 2) [N m, N]. */
static inline PaminsaReach paminsa_gravity_torques(const PaminsaDesign *design,
    const double pose[4], double torque[4])
{
    const PaminsaMechanism *m = &design->mechanism;
    const PaminsaEnergyTerms *e = &design->energy;
    PaminsaReach reach = paminsa_reach(design, pose);

    paminsa_fill(torque, 4, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    const PaminsaUnitTorques gamma =
        paminsa_unit_torques(m, pose[0], pose[1], cos(pose[2]), sin(pose[2]), pose[3]);
    if (!paminsa_finite(gamma.values, 4)) {
        reach.status = PAMINSA_STATUS_SINGULAR;
        return reach;
    }
    for (int i = 0; i < 4; i++)
        torque[i] = e->v9 * gamma.values[i]; /* M_p2 Gamma_i */
    torque[3] += m->k * (e->mass * design->gravity + 3.0 * e->v5) + 3.0 * e->vz;
    return reach;
}

/* Give the torques that hold the robot at rest, its weight and the load [N m, N] (Eqs. 1-6). */
static inline PaminsaReach paminsa_static_torques(const PaminsaDesign *design,
    const double pose[4], double torque[4])
{
    const PaminsaReach reach = paminsa_gravity_torques(design, pose, torque);

    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    return paminsa_subtract_load(design, pose, reach, torque);
}

/* Whether anything depends on the motion of the actuators themselves; no unit, not in the paper. */
static inline int paminsa_has_drives(const PaminsaDesign *design)
{
    for (int i = 0; i < 4; i++)
        if (design->viscous[i] != 0.0 || design->coulomb[i] != 0.0 ||
            design->drive_inertia[i] != 0.0)
            return 1;
    return 0;
}

/* Give the torques of a motion (Eqs. 15-21), load, friction and drives included [N m, N].
 *
 * velocity [m/s, m/s, rad/s, m/s] and acceleration [m/s^2, m/s^2, rad/s^2, m/s^2] are those of
 * (x, y, theta, z).
 */
static inline PaminsaReach paminsa_inverse_dynamics(const PaminsaDesign *design,
    const double pose[4], const double velocity[4], const double acceleration[4],
    double torque[4])
{
    const double *p = pose, *v = velocity, *a = acceleration;
    double speed[4], growth[4], friction[4], drives[4];
    PaminsaReach reach = paminsa_reach(design, pose);

    paminsa_fill(torque, 4, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    if (!paminsa_finite(velocity, 4) || !paminsa_finite(acceleration, 4)) {
        reach.status = PAMINSA_STATUS_NOT_FINITE;
        return reach;
    }
    const PaminsaActuatorForces forces = paminsa_inverse_dynamics_kernel(&design->mechanism,
        &design->energy, design->gravity, p[0], p[1], cos(p[2]), sin(p[2]), p[3], v[0], v[1], v[2],
        v[3], a[0], a[1], a[2], a[3]);
    const double found[4] = {forces.tau1, forces.tau2, forces.tau3, forces.f4};
    if (!paminsa_finite(found, 4)) {
        reach.status = PAMINSA_STATUS_SINGULAR;
        return reach;
    }
    for (int i = 0; i < 4; i++)
        torque[i] = found[i];
    if (paminsa_has_drives(design)) {
        paminsa_actuator_motion(design, pose, velocity, acceleration, speed, growth);
        paminsa_friction_torques(design, speed, friction);
        paminsa_drive_torques(design, growth, drives);
        for (int i = 0; i < 4; i++)
            torque[i] += drives[i] + friction[i];
    }
    return paminsa_subtract_load(design, pose, reach, torque);
}

/* Give the torques of many motions at once [N m, N] (Eqs. 15-21), without load, friction, drives.
 *
 * Numbers stand in columns of count each, so that compilers can work on several states at a time;
 * README.md says with which options. in has 13 columns: x, y [m], cos theta, sin theta, z [m], then
 * rates [m/s, m/s, rad/s, m/s] and accelerations [m/s^2, m/s^2, rad/s^2, m/s^2] of (x, y, theta,
 * z). out has 4: tau_1, tau_2, tau_3, F_4; NaN out of reach, not finite at a singularity.
 */
static inline PAMINSA_FLAT void paminsa_inverse_dynamics_columns(const PaminsaDesign *design,
    long count, const double *PAMINSA_RESTRICT in, double *PAMINSA_RESTRICT out)
{
    const PaminsaMechanism m = design->mechanism;
    const PaminsaEnergyTerms e = design->energy;
    const double gravity = design->gravity;

    for (long i = 0; i < count; i++) {
        const double *v = in + i;
        const PaminsaActuatorForces f = paminsa_inverse_dynamics_kernel(&m, &e, gravity,
            v[0], v[count], v[2 * count], v[3 * count], v[4 * count], v[5 * count], v[6 * count],
            v[7 * count], v[8 * count], v[9 * count], v[10 * count], v[11 * count],
            v[12 * count]);
        out[i] = f.tau1;
        out[count + i] = f.tau2;
        out[2 * count + i] = f.tau3;
        out[3 * count + i] = f.f4;
    }
}

/* Give M with T = v.M v/2 in (x, y, theta, z), drives included [kg, kg m, kg m^2] (Eqs. 12-14).
 *
 * It exists at type-2 singularities, too.
 */
static inline PaminsaReach paminsa_mass_matrix_of(const PaminsaDesign *design,
    const double pose[4], double matrix[4][4])
{
    double g[4][4];
    const PaminsaReach reach = paminsa_inverse_jacobian(design, pose, g);

    paminsa_fill_matrix(matrix, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    const PaminsaMassMatrix upper = paminsa_mass_matrix(&design->mechanism, &design->energy,
        pose[0], pose[1], cos(pose[2]), sin(pose[2]), pose[3]);
    int next = 0;
    for (int row = 0; row < 4; row++)
        for (int column = row; column < 4; column++) {
            double entry = upper.values[next++];
            for (int i = 0; i < 4; i++)
                entry += g[i][row] * design->drive_inertia[i] * g[i][column];
            matrix[row][column] = matrix[column][row] = entry;
        }
    return reach;
}

/* Give the platform's acceleration under actuator torques, load and friction included: Eqs. 15-21
 * solved for it.
 *
 * torque is (tau_1, tau_2, tau_3, F_4) [N m, N]; the result is [m/s^2, m/s^2, rad/s^2, m/s^2].
 */
static inline PaminsaReach paminsa_forward_dynamics(const PaminsaDesign *design,
    const double pose[4], const double velocity[4], const double torque[4],
    double acceleration[4])
{
    static const double rest[4] = {0.0, 0.0, 0.0, 0.0};
    double bias[4], g[4][4], m[4][4];
    double force[4] = {0.0, 0.0, 0.0, 0.0};
    PaminsaReach reach = paminsa_inverse_dynamics(design, pose, velocity, rest, bias);

    paminsa_fill(acceleration, 4, NAN);
    if (reach.status != PAMINSA_STATUS_OK)
        return reach;
    if (!paminsa_finite(torque, 4)) {
        reach.status = PAMINSA_STATUS_NOT_FINITE;
        return reach;
    }
    paminsa_inverse_jacobian(design, pose, g);
    paminsa_mass_matrix_of(design, pose, m);
    for (int row = 0; row < 4; row++)
        for (int i = 0; i < 4; i++)
            force[row] += g[i][row] * (torque[i] - bias[i]);
    const PaminsaAcceleration found = paminsa_acceleration_of_force(m[0][0], m[0][1], m[0][2],
        m[0][3], m[1][1], m[1][2], m[1][3], m[2][2], m[2][3], m[3][3], force[0], force[1],
        force[2], force[3]);
    if (!(found.pivot > 0.0)) {
        reach.status = PAMINSA_STATUS_SINGULAR;
        return reach;
    }
    acceleration[0] = found.x;
    acceleration[1] = found.y;
    acceleration[2] = found.theta;
    acceleration[3] = found.z;
    return reach;
}

/* Measure a pose against every singularity, [m], [rad] and no unit as in PaminsaSingularity;
 * determinant and condition, of the J of Eq. 3, are NaN beyond the limits.
 */
static inline PaminsaSingularity paminsa_singularity(const PaminsaDesign *design,
    const double pose[4])
{
    const PaminsaMechanism *m = &design->mechanism;
    const double c = cos(pose[2]), s = sin(pose[2]);
    const PaminsaDexterity dexterity = paminsa_dexterity(m, pose[0], pose[1], c, s, pose[3]);
    const PaminsaSingularDistances far =
        paminsa_singular_distances(m, pose[0], pose[1], c, fabs(paminsa_wrap_angle(pose[2])));
    PaminsaSingularity found = {NAN, NAN, NAN, NAN, INFINITY};
    double margins[3][4];

    found.determinant = dexterity.values[0];
    found.condition = dexterity.values[1];
    found.position_distance = far.position;
    found.rotation_distance = far.rotation;
    paminsa_margins(design, pose, margins);
    for (int leg = 0; leg < 3; leg++) {
        const double kinds[3] = {margins[leg][0], margins[leg][1], margins[leg][3] + m->clearance};
        for (int i = 0; i < 3; i++)
            if (!(kinds[i] >= found.serial_distance))
                found.serial_distance = kinds[i];
    }
    return found;
}
