/* Reads the files 0.npy, 1.npy ... of a folder as the first table of one FMU, linked in; tells how many were taken. */
#include <stdio.h>

#include "fmu.c"

int main(int argc, char **argv) {
    int taken = 0;
    for (int i = 0; argc == 3 && i < atoi(argv[2]); i++) {
        Table table = {0};
        char problem[900], name[32];
        snprintf(name, sizeof name, "%d.npy", i);
        if (table_load(&table, &model.tables[0], name, argv[1], problem, sizeof problem) == 0) {
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
