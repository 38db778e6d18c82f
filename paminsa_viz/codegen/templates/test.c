/* Checks paminsa.h against vectors.csv; see README.md.
 *
 *     cc -std=c99 -O2 -ffp-contract=off test.c -o test -lm && ./test vectors.csv
 *
 * Prints the worst error of each function and returns 0 if all are small enough, 1 if not, 2 if the
 * table cannot be read. Errors are relative to the largest value of a column: those of a torque to
 * the largest torque of its actuator, and accelerations to those of the robot let go, too.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "paminsa.h"
#include "design.h"

#define TOLERANCE @TOLERANCE@
#define COLUMNS @COLUMNS@

typedef double Real; /* of paminsa.h; what is printed is double in any case */

typedef struct {
    const char *name;
    double worst;
} Check;

static void compare(Check *check, const double *got, const double *wanted, const double *sizes,
    int count)
{
    for (int i = 0; i < count; i++) {
        double error = fabs(got[i] - wanted[i]);
        if (error > 0.0)
            error /= sizes[i];
        if ((isnan(got[i]) && isnan(wanted[i])) ||
            (isinf(got[i]) && isinf(wanted[i]) && (got[i] > 0.0) == (wanted[i] > 0.0)))
            error = 0.0; /* a distance to what does not exist is infinite */
        else if (isnan(error))
            error = INFINITY;
        if (error > check->worst)
            check->worst = error;
    }
}

static int read_row(FILE *file, double row[COLUMNS])
{
    char word[64];

    for (int i = 0; i < COLUMNS; i++) {
        if (fscanf(file, " %63[^,\n]", word) != 1)
            return 0;
        row[i] = (Real)strtod(word, NULL);
        (void)fgetc(file);
    }
    return 1;
}

static FILE *open_rows(const char *name)
{
    FILE *file = fopen(name, "r");
    int letter;

    if (file == NULL)
        return NULL;
    do
        letter = fgetc(file);
    while (letter != '\n' && letter != EOF);
    return file;
}

static double larger(double a, double b)
{
    return b > a ? b : a; /* a if b is NaN */
}

/* Find the largest finite value of each column. */
static void find_largest(FILE *file, double largest[COLUMNS])
{
    double row[COLUMNS];

    for (int i = 0; i < COLUMNS; i++)
        largest[i] = 0.0;
    while (read_row(file, row))
        for (int i = 0; i < COLUMNS; i++)
            if (!isinf(row[i]))
                largest[i] = larger(largest[i], fabs(row[i]));
}

int main(int count, char **words)
{
    const char *name = count > 1 ? words[1] : "vectors.csv";
    FILE *file = open_rows(name);
    Check checks[] = {
        {"status", 0.0}, {"inverse kinematics", 0.0}, {"inverse Jacobian", 0.0},
        {"Jacobian", 0.0}, {"static torques", 0.0}, {"inverse dynamics", 0.0},
        {"mass matrix", 0.0}, {"forward dynamics", 0.0}, {"forward kinematics", 0.0},
        {"friction", 0.0}, {"margin", 0.0}, {"singularities", 0.0},
        {"formulas, given cos and sin theta", 0.0},
    };
    const int number = (int)(sizeof checks / sizeof checks[0]);
    const double units[2] = {1.0, 1.0};
    double row[COLUMNS], largest[COLUMNS];
    int rows = 0, failed = 0;

    if (file == NULL) {
        fprintf(stderr, "%s cannot be read\n", name);
        return 2;
    }
    find_largest(file, largest);
    fclose(file);
    file = open_rows(name);
    if (file == NULL)
        return 2;
    while (read_row(file, row)) {
        const double *pose = row, *c = row + 4, *velocity = row + 6, *acceleration = row + 10;
        const double *next = row + 14;
        const PaminsaDesign *design = &PAMINSA_DESIGN;
        const double *size = largest + 14;
        const double none[4] = {0.0, 0.0, 0.0, 0.0};
        double four[4], nearest[4], sizes[4], matrix[4][4];

        const PaminsaReach reach = paminsa_inverse_kinematics(design, pose, four);
        const double status[2] = {(Real)reach.status, (Real)reach.leg};
        compare(&checks[0], status, next, units, 2);
        compare(&checks[1], four, next + 2, size + 2, 4);
        next += 6;
        size += 6;
        if (reach.status == PAMINSA_STATUS_OK) {
            paminsa_nearest_pose(design, four, pose, nearest);
            compare(&checks[8], nearest, pose, largest, 4);
        }
        paminsa_inverse_jacobian(design, pose, matrix);
        for (int i = 0; i < 4; i++, next += 4, size += 4)
            compare(&checks[2], matrix[i], next, size, 4);
        paminsa_jacobian(design, pose, matrix);
        for (int i = 0; i < 4; i++, next += 4, size += 4)
            compare(&checks[3], matrix[i], next, size, 4);
        for (int i = 0; i < 4; i++) /* a balanced robot has static torques of rounding alone */
            sizes[i] = larger(size[i], size[4 + i]);
        paminsa_static_torques(design, pose, four);
        compare(&checks[4], four, next, sizes, 4);
        paminsa_inverse_dynamics(design, pose, velocity, acceleration, four);
        compare(&checks[5], four, next + 4, sizes, 4);
        paminsa_forward_dynamics(design, pose, none, none, four);
        for (int i = 0; i < 4; i++) /* what torques and gravity do cancels for the most part */
            sizes[i] = larger(size[8 + i], fabs(four[i]));
        paminsa_forward_dynamics(design, pose, velocity, next + 4, four);
        compare(&checks[7], four, next + 8, sizes, 4);
        next += 12;
        size += 12;
        paminsa_mass_matrix_of(design, pose, matrix);
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++)
                sizes[j] = sqrt(size[5 * i] * size[5 * j]);
            compare(&checks[6], matrix[i], next + 4 * i, sizes, 4);
        }
        next += 16;
        size += 16;
        paminsa_friction_torques(design, velocity, four);
        compare(&checks[9], four, next, size, 4);
        compare(&checks[10], &reach.margin, next + 4, size + 4, 1);
        const PaminsaSingularity far = paminsa_singularity(design, pose);
        const double measures[5] = {far.determinant, far.condition, far.position_distance,
            far.rotation_distance, far.serial_distance};
        compare(&checks[11], measures, next + 5, size + 5, 5);
        next += 10;
        size += 10;
        const PaminsaUnitTorques gamma =
            paminsa_unit_torques(&design->mechanism, pose[0], pose[1], c[0], c[1], pose[3]);
        compare(&checks[12], gamma.values, next, size, 4);
        rows++;
    }
    fclose(file);
    if (rows == 0) {
        fprintf(stderr, "%s holds no complete row\n", name);
        return 2;
    }
    for (int i = 0; i < number; i++) {
        printf("%-34s worst error %9.2e\n", checks[i].name, (double)checks[i].worst);
        failed += !(checks[i].worst <= TOLERANCE);
    }
    printf("%d rows, tolerance %g: %s\n", rows, (double)TOLERANCE, failed ? "FAILED" : "passed");
    return failed ? 1 : 0;
}
