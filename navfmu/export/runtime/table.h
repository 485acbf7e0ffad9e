/* Tables: files of numbers in the FMU's resources, searched by their first column. */
#ifndef NAVFMU_TABLE_H
#define NAVFMU_TABLE_H

#include <stddef.h>

#include "model.h"

typedef struct {
    int columns, rows; /* rows >= 2 */
    double *values; /* row after row */
} Table;

/* Read resources/FILE. Returns 0 when done, else writes a sentence to `problem`. */
static int table_load(Table *table, const TableInfo *info, const char *resources, char *problem, size_t size);
static void table_free(Table *table);

/* A number that depends on every bit of the table, and on the number of the tables before it. */
static uint64_t table_number(const Table *table, uint64_t before);

/* Copy the last row not after `time` and the row that follows it; the cursor remembers the place for the next call.
   Before the first row these are the first two rows, after the last row the last two. */
static void table_rows(const Table *table, double time, int64_t *cursor, double *out);

#endif
