/* Reads each file that is named as the first table of one FMU, linked in, and tells how many were taken. */
#include <stdio.h>

#include "fmu.c"

int main(int argc, char **argv) {
    int taken = 0;
    for (int i = 1; i < argc; i++) {
        Table table = {0};
        char problem[900];
        if (table_load(&table, &model.tables[0], argv[i], NULL, problem, sizeof problem) == 0) {
            double out[64];
            for (int k = -2; k <= table.sizes[0]; k++) {
                if (table.info->grid) table_corners(&table, 0, k + 2, table.info->columns - 2, k, 0.5 * k, out);
                else table_rows(&table, 0, k + 2, table.info->keys[0], table.info->columns, k, out);
            }
            taken++;
        } else if (!strchr(problem, '.')) {
            return 1;
        }
        table_free(&table);
    }
    printf("%d\n", taken);
    return 0;
}
