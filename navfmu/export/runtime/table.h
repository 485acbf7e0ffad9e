/* Tables: files of numbers in the FMU's resources, searched by columns that increase. */
#ifndef NAVFMU_TABLE_H
#define NAVFMU_TABLE_H

#include <stddef.h>

#include "model.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "Tables are read as they lie in their files, least byte first, which this machine does not understand."
#endif

enum { SEARCHES = 16 }; /* that remember where they have ended; more than these share their places */

struct Table {
    const TableInfo *info;
    char *name;      /* of the file that it was read from, as it was given; "" for its own */
    int sizes[2];    /* rows, -1; of a grid the numbers of its axes */
    size_t count;
    double *values;  /* row after row; of a grid the axes, then surface after surface */
    uint64_t number; /* depends on every bit of these and on the sizes */
    int64_t last[SEARCHES][2]; /* where searches have ended (on either axis): saves time, decides nothing */
};

/* Whether it is the name of a file in the resources. What lies elsewhere is no part of the FMU, and could change without
   anybody's knowing. */
static int table_is_within(const char *name);

/* Read the file of this name in the resources; "" is the table's own. Returns 0 when done, else writes a sentence to
   `problem`; then, too, what was allocated is to be freed. */
static int table_load(Table *table, const TableInfo *info, const char *name, const char *resources, char *problem,
                      size_t size);
static void table_free(Table *table);

/* A number that depends on another one and on every bit of these. */
static uint64_t table_mix(uint64_t number, uint64_t bits);

/* Copy the last row of a table whose number in the column `key` is not above `value`, and the row that follows it. Below
   the first row these are the first two rows; above the last row, and for NaN, the last two. Searches have numbers. */
static inline void table_rows(Table *tables, int table, int search, int key, int columns, double value, double *out);

/* Copy the ends of a grid's cell around (x, y) on both axes, then the surfaces at its corners: (0, 0), (0, 1), (1, 0) and
   (1, 1), ends on the first and on the second axis. Outside, and for NaN, the cell is found as a row is. */
static inline void table_corners(Table *tables, int table, int search, int surfaces, double x, double y,
                                 double *out);

#endif
