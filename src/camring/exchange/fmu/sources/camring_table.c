#ifndef CAMRING_TABLE_C
#define CAMRING_TABLE_C
#ifdef _MSC_VER
#define _CRT_SECURE_NO_WARNINGS
#endif
#include "camring_table.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The file, little-endian: these eight bytes, six counts as int32 (length of each axis, samples
   of an angle, quantities, periods of the ripple in a revolution), the axes and the means as
   float64, the coefficients of the waves as float32. */
static const char CAMRING_MAGIC[8] = {'C', 'A', 'M', 'R', 'I', 'N', 'G', '1'};
enum { CAMRING_COUNTS = CAMRING_AXES + 3, CAMRING_MOST = 100000 };

struct CamringTable {
    size_t length[CAMRING_AXES];
    size_t angles;
    size_t periods;
    double *axis[CAMRING_AXES];
    double *means;  /* [speed][drop][low][quantity] */
    float *waves;   /* [speed][drop][low][quantity][angle], of cubic B-splines */
};

static CamringTable *camring_refuse(CamringTable *table, FILE *file, char *message,
                                    unsigned long size, const char *why, const char *path)
{
    if (file) fclose(file);
    camring_table_close(table);
    snprintf(message, size, "the table %.400s %s", path, why);
    return NULL;
}

static int camring_ascends(const double *axis, size_t length)
{
    size_t i;
    for (i = 1; i < length; i++)
        if (!(axis[i] > axis[i - 1])) return 0;
    return 1;
}

CAMRING_LINKAGE CamringTable *camring_table_open(const char *path, char *message,
                                                 unsigned long size)
{
    const uint16_t one = 1;
    char magic[sizeof CAMRING_MAGIC];
    int32_t count[CAMRING_COUNTS];
    size_t places = 1, i;
    CamringTable *table = NULL;
    FILE *file = fopen(path, "rb");

    if (!file) return camring_refuse(table, file, message, size, "cannot be opened", path);
    if (*(const unsigned char *)&one != 1)
        return camring_refuse(table, file, message, size, "is for little-endian machines", path);
    if (fread(magic, 1, sizeof magic, file) != sizeof magic
        || memcmp(magic, CAMRING_MAGIC, sizeof magic) != 0
        || fread(count, sizeof *count, CAMRING_COUNTS, file) != CAMRING_COUNTS)
        return camring_refuse(table, file, message, size, "is none of camring's", path);
    for (i = 0; i < CAMRING_COUNTS; i++)
        if (count[i] < 1 || count[i] > CAMRING_MOST)
            return camring_refuse(table, file, message, size, "has impossible counts", path);
    if (count[CAMRING_AXES + 1] != CAMRING_QUANTITIES)
        return camring_refuse(table, file, message, size, "has other quantities", path);

    table = calloc(1, sizeof *table);
    if (!table) return camring_refuse(table, file, message, size, "finds no memory", path);
    table->angles = (size_t)count[CAMRING_AXES];
    table->periods = (size_t)count[CAMRING_AXES + 2];
    for (i = 0; i < CAMRING_AXES; i++) {
        table->length[i] = (size_t)count[i];
        places *= table->length[i];
        table->axis[i] = calloc(table->length[i], sizeof(double));
        if (!table->axis[i])
            return camring_refuse(table, file, message, size, "finds no memory", path);
        if (fread(table->axis[i], sizeof(double), table->length[i], file) != table->length[i])
            return camring_refuse(table, file, message, size, "is cut off", path);
        if (!camring_ascends(table->axis[i], table->length[i]))
            return camring_refuse(table, file, message, size, "has an axis out of order", path);
    }
    places *= CAMRING_QUANTITIES;
    table->means = calloc(places, sizeof(double));
    table->waves = calloc(places * table->angles, sizeof(float));
    if (!table->means || !table->waves)
        return camring_refuse(table, file, message, size, "finds no memory", path);
    if (fread(table->means, sizeof(double), places, file) != places
        || fread(table->waves, sizeof(float), places * table->angles, file)
               != places * table->angles)
        return camring_refuse(table, file, message, size, "is cut off", path);
    fclose(file);
    return table;
}

CAMRING_LINKAGE void camring_table_close(CamringTable *table)
{
    size_t i;
    if (!table) return;
    for (i = 0; i < CAMRING_AXES; i++) free(table->axis[i]);
    free(table->means);
    free(table->waves);
    free(table);
}

CAMRING_LINKAGE void camring_table_range(const CamringTable *table, int axis, double range[2])
{
    range[0] = table->axis[axis][0];
    range[1] = table->axis[axis][table->length[axis] - 1];
}

CAMRING_LINKAGE void camring_coordinates(const CamringInputs *inputs, double coordinate[CAMRING_AXES])
{
    const double supply = inputs->supply_pressure, back = inputs->return_pressure;
    coordinate[CAMRING_SPEED] = inputs->speed;
    coordinate[CAMRING_DROP] = supply - back;
    coordinate[CAMRING_LOW] = (supply < back ? supply : back) - inputs->case_pressure;
}

/* The interval an input stands in, its share of it, and whether it was held: 1 low, 2 high. */
static unsigned camring_place(const double *axis, size_t length, double value,
                              size_t *before, double *share)
{
    size_t low = 0, high = length - 1;
    *before = 0;
    *share = 0;
    if (value < axis[0]) return 1;
    if (value > axis[high]) {
        *before = high > 0 ? high - 1 : 0;
        *share = high > 0 ? 1 : 0;
        return 2;
    }
    if (high == 0) return 0;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (axis[middle] <= value) low = middle; else high = middle;
    }
    *before = low;
    *share = (value - axis[low]) / (axis[high] - axis[low]);
    return 0;
}

/* Four neighbouring coefficients of a periodic cubic spline, and their weights. */
static void camring_ripple_at(const CamringTable *table, double angle, size_t tap[4],
                              double weight[4])
{
    const double revolution = 6.283185307179586;
    const double periods = angle / revolution * (double)table->periods;
    const double along = (periods - floor(periods)) * (double)table->angles;
    const size_t start = (size_t)along;
    const double t = along - (double)start, s = 1 - t;
    size_t i;
    for (i = 0; i < 4; i++) tap[i] = (start + table->angles + i - 1) % table->angles;
    weight[0] = s * s * s / 6;
    weight[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    weight[2] = (3 * s * s * s - 6 * s * s + 4) / 6;
    weight[3] = t * t * t / 6;
}

CAMRING_LINKAGE unsigned camring_table_look_up(const CamringTable *table,
                                               const CamringInputs *inputs,
                                               double result[CAMRING_QUANTITIES])
{
    double coordinate[CAMRING_AXES], share[CAMRING_AXES], weight[4];
    size_t before[CAMRING_AXES], tap[4], axis, corner, quantity, i;
    unsigned held = 0;

    camring_coordinates(inputs, coordinate);
    for (axis = 0; axis < CAMRING_AXES; axis++)
        held |= camring_place(table->axis[axis], table->length[axis], coordinate[axis],
                              &before[axis], &share[axis]) << (2 * axis);
    camring_ripple_at(table, inputs->angle, tap, weight);
    for (quantity = 0; quantity < CAMRING_QUANTITIES; quantity++) result[quantity] = 0;

    for (corner = 0; corner < 8; corner++) {
        double part = 1;
        size_t place = 0;
        for (axis = 0; axis < CAMRING_AXES; axis++) {
            const size_t after = corner >> axis & 1;
            part *= after ? share[axis] : 1 - share[axis];
            place = place * table->length[axis] + before[axis] + after;
        }
        if (part == 0) continue;  /* the corner after the last place has no share */
        for (quantity = 0; quantity < CAMRING_QUANTITIES; quantity++) {
            const size_t cell = place * CAMRING_QUANTITIES + quantity;
            const float *wave = table->waves + cell * table->angles;
            double value = 0;
            if (inputs->ripple)
                for (i = 0; i < 4; i++) value += weight[i] * wave[tap[i]];
            else
                value = table->means[cell];
            result[quantity] += part * value;
        }
    }
    return held;
}

#endif
