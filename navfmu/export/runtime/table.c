#include "table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <wchar.h>
/* The one function that is needed of windows.h, without the hundreds of names that it takes. */
__declspec(dllimport) int __stdcall MultiByteToWideChar(unsigned code_page, unsigned long flags, const char *text,
                                                        int length, wchar_t *wide, int room);
enum { UTF_8 = 65001 };
#endif

static int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    c |= 0x20;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

static int starts_with(const char *text, const char *lower) {
    for (; *lower; text++, lower++) {
        char c = *text >= 'A' && *text <= 'Z' ? (char)(*text | 0x20) : *text;
        if (c != *lower) return 0;
    }
    return 1;
}

static int table_is_within(const char *name) {
    return name[0] != '/' && !strpbrk(name, "\\:") && !strstr(name, "..");
}

/* fmuResourceLocation is a URI (file:///dir, file:/dir, file://localhost/dir, file://server/dir); plain paths, which
   some hosts pass, are taken as they are. Returns a new string, or NULL. */
static char *path_from_uri(const char *uri, const char *file) {
    int is_uri = starts_with(uri, "file:");
    if (is_uri) {
        uri += 5;
        if (starts_with(uri, "//localhost/")) uri += 11;
        else if (uri[0] == '/' && uri[1] == '/' && uri[2] == '/') uri += 2;
#ifdef _WIN32
        if (uri[0] == '/' && uri[1] && (uri[2] == ':' || starts_with(uri + 2, "%3a"))) uri++;
#endif
    }
    size_t length = strlen(uri);
    char *path = malloc(length + strlen(file) + 2), *end = path;
    if (!path) return NULL;
    for (size_t i = 0; i < length; i++) {
        int high = is_uri && uri[i] == '%' ? hex_digit(uri[i + 1]) : -1;
        int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        if (low >= 0) i += 2;
        *end++ = low >= 0 ? (char)(16 * high + low) : uri[i];
    }
    if (end > path && end[-1] != '/' && end[-1] != '\\') *end++ = '/';
    strcpy(end, file);
    return path;
}

static FILE *open_file(const char *path) {
#ifdef _WIN32
    int count = MultiByteToWideChar(UTF_8, 0, path, -1, NULL, 0);
    wchar_t *wide = calloc((size_t)count + 1, sizeof *wide);
    if (!wide) return NULL;
    MultiByteToWideChar(UTF_8, 0, path, -1, wide, count);
    FILE *file = _wfopen(wide, L"rb");
    free(wide);
    return file;
#else
    return fopen(path, "rb");
#endif
}

/* ---- files of NumPy's format: magic, version, length of the header, header, numbers ---- */

/* A header, which ends in spaces and a line end, against that of the model, in which the bytes 1 and 2 stand for sizes:
   the first of each sets the size, any other must be the same. */
static int fits(const char *header, size_t length, const char *model_header, int *sizes) {
    const char *end = header + length;
    for (const char *c = model_header; *c; c++) {
        if ((unsigned char)*c > 2) {
            if (header == end || *header++ != *c) return 0;
            continue;
        }
        int number = 0, digits = 0, *size = &sizes[*c - 1];
        for (; header < end && *header >= '0' && *header <= '9' && digits < 9; header++, digits++) {
            number = 10 * number + (*header - '0');
        }
        if (!digits || (*size >= 0 && *size != number)) return 0;
        *size = number;
    }
    while (header < end && *header == ' ') header++;
    return header + 1 == end && *header == '\n';
}

/* A header as it is printed: some 300 characters of it, "..." where a size stands. */
static const char *printed(const char *header, size_t length, char *room) {
    char *end = room;
    for (; length && end < room + 300; header++, length--) {
        if (*header == 1 || *header == 2) *end++ = '.', *end++ = '.', *end++ = '.';
        else *end++ = *header == '\n' ? ' ' : *header >= ' ' && *header <= '~' ? *header : '?';
    }
    while (end > room && end[-1] == ' ') end--;
    *end = 0;
    return room;
}

/* The header, or NULL when the file is another one or ends in it. */
static char *read_header(FILE *file, size_t *length) {
    unsigned char start[12];
    if (fread(start, 1, 10, file) != 10 || memcmp(start, "\x93NUMPY", 6) != 0) return NULL;
    *length = start[8] | (size_t)start[9] << 8;
    if (start[6] > 1) { /* of versions 2 and 3 the length has four bytes */
        if (fread(start + 10, 1, 2, file) != 2 || start[11]) return NULL;
        *length |= (size_t)start[10] << 16;
    }
    char *header = malloc(*length + 1);
    if (header && fread(header, 1, *length, file) == *length) return header;
    free(header);
    return NULL;
}

/* Column c of the table: its first number, their distance in memory, how many there are. */
static const double *column_of(const Table *table, int c, size_t *distance, size_t *count) {
    const size_t first = (size_t)table->sizes[0], second = (size_t)table->sizes[1];
    if (!table->info->grid) {
        *distance = (size_t)table->info->columns;
        *count = first;
        return table->values + c;
    }
    *distance = 1;
    *count = c == 0 ? first : c == 1 ? second : first * second;
    return table->values + (c == 0 ? 0 : c == 1 ? first : first + second + (size_t)(c - 2) * first * second);
}

static int all_finite(const double *values, size_t count) {
    const uint64_t exponent = UINT64_C(0x7FF0000000000000);
    uint64_t bits, wrong = 0;
    for (size_t i = 0; i < count; i++) {
        memcpy(&bits, &values[i], sizeof bits);
        wrong |= (bits & exponent) == exponent;
    }
    return !wrong;
}

static int is_key(const TableInfo *info, int column) {
    for (int k = 0; k < info->key_count; k++) {
        if (info->keys[k] == column) return 1;
    }
    return 0;
}

/* What the numbers must be: finite, and those of a key increasing. */
static int check(const Table *table, const char *path, char *problem, size_t size) {
    const int good = all_finite(table->values, table->count);
    for (int c = 0; c < table->info->columns; c++) {
        size_t distance, count;
        const double *column = column_of(table, c, &distance, &count);
        const char *label = table->info->labels[c];
        for (size_t i = 0; i < count && !good; i++) {
            double value = column[i * distance];
            if (isfinite(value)) continue;
            snprintf(problem, size, "The table %s: number %.0f of %.0f in '%s' is %g; expected a finite one.", path,
                     (double)(i + 1), (double)count, label, value == value ? value : (double)NAN);
            return 1;
        }
        if (!is_key(table->info, c)) continue;
        if (count < 2) {
            snprintf(problem, size, "The table %s has %.0f numbers in '%s'; expected at least 2.", path, (double)count,
                     label);
            return 1;
        }
        for (size_t i = 1; i < count; i++) {
            double before = column[(i - 1) * distance], value = column[i * distance];
            if (value > before) continue;
            snprintf(problem, size, "The table %s: number %.0f of %.0f in '%s', %g, is not greater than the one before, %g.",
                     path, (double)(i + 1), (double)count, label, value, before);
            return 1;
        }
    }
    return 0;
}

/* As in FNV, by words; then high bits reach low ones, too. */
static uint64_t table_mix(uint64_t number, uint64_t bits) {
    number = (number ^ bits) * 0x9E3779B97F4A7C15u;
    return number ^ number >> 32;
}

static uint64_t number_of(const Table *table) {
    uint64_t number = (uint64_t)table->sizes[0] ^ (uint64_t)table->sizes[1] << 32, bits;
    for (size_t i = 0; i < table->count; i++) {
        memcpy(&bits, &table->values[i], sizeof bits);
        number = table_mix(number, bits);
    }
    return number;
}

static int read_table(Table *table, FILE *file, const char *path, char *problem, size_t size) {
    const TableInfo *info = table->info;
    char one[310], other[310];
    size_t length;
    char *header = file ? read_header(file, &length) : NULL;
    if (!header) {
        const int other_file = file && !ferror(file);
        snprintf(problem, size, other_file ? "The table %s is no file of NumPy's format." : "The table %s cannot be read.", path);
        return 1;
    }
    table->sizes[0] = table->sizes[1] = -1;
    const int fit = fits(header, length, info->header, table->sizes);
    if (!fit) {
        snprintf(problem, size, "The table %s has the header %s; expected %s.", path, printed(header, length, one),
                 printed(info->header, strlen(info->header), other));
    }
    free(header);
    if (!fit) return 1;

    const double first = table->sizes[0], second = table->sizes[1];
    const double count = info->grid ? first + second + (info->columns - 2) * first * second : info->columns * first;
    table->count = count < (double)(SIZE_MAX / 16) ? (size_t)count : 0;
    table->values = malloc(table->count * sizeof(double) + 1); /* none is no NULL */
    if (!table->values || (double)table->count != count) {
        snprintf(problem, size, "There is not enough memory for the table %s.", path);
        return 1;
    }
    const size_t read = fread(table->values, sizeof(double), table->count, file);
    if (read != table->count || fgetc(file) != EOF) {
        snprintf(problem, size, "The table %s has %s than the %.0f numbers of its header.", path,
                 read < table->count ? "less" : "more", count);
        return 1;
    }
    if (check(table, path, problem, size)) return 1;
    table->number = number_of(table);
    return 0;
}

static int table_load(Table *table, const TableInfo *info, const char *name, const char *resources, char *problem,
                      size_t size) {
    const char *called = *name ? name : info->file;
    table->info = info;
    if (!resources || !*resources) {
        snprintf(problem, size, "No fmuResourceLocation was given, but this FMU reads the table resources/%s.", called);
        return 1;
    }
    char *path = path_from_uri(resources, called);
    table->name = malloc(strlen(name) + 1);
    if (!path || !table->name) {
        snprintf(problem, size, "There is not enough memory for the table %s.", called);
        free(path);
        return 1;
    }
    strcpy(table->name, name);
    FILE *file = open_file(path);
    const int failed = read_table(table, file, path, problem, size);
    if (file) fclose(file);
    free(path);
    return failed;
}

static void table_free(Table *table) {
    free(table->values);
    free(table->name);
    table->values = NULL;
    table->name = NULL;
}

/* ---- searches ---- */

/* The last place from 0 to `last` whose number is not above the value; 0 if there is none, `last` for NaN. It is looked
   for in steps that double, from the place `from`, and then between two steps: near by it takes two comparisons. */
static inline int64_t find(const double *numbers, size_t distance, int64_t last, double value, int64_t from) {
    if (value != value) return last;
    int64_t low = from, high = from + 1, step = 1; /* the place is low or above, and below high */
    if (numbers[(size_t)low * distance] <= value) {
        while (high <= last && numbers[(size_t)high * distance] <= value) {
            low = high;
            step *= 2;
            high = low + step;
        }
        if (high > last + 1) high = last + 1;
    } else {
        do {
            high = low;
            low -= step;
            step *= 2;
        } while (low > 0 && !(numbers[(size_t)low * distance] <= value));
        if (low < 0) low = 0;
    }
    while (high - low > 1) {
        const int64_t middle = low + (high - low) / 2;
        if (numbers[(size_t)middle * distance] <= value) low = middle;
        else high = middle;
    }
    return low;
}

static inline void table_rows(Table *tables, int table, int search, int key, int columns, double value, double *out) {
    Table *of = &tables[table];
    int64_t *last = of->last[search % SEARCHES];
    const int64_t row = last[0] = find(of->values + key, (size_t)columns, of->sizes[0] - 2, value, last[0]);
    memcpy(out, of->values + (size_t)row * (size_t)columns, 2 * (size_t)columns * sizeof *out);
}

static inline void table_corners(Table *tables, int table, int search, int surfaces, double x, double y,
                                 double *out) {
    Table *of = &tables[table];
    const size_t first = (size_t)of->sizes[0], second = (size_t)of->sizes[1];
    const double *xs = of->values, *ys = xs + first, *heights = ys + second;
    int64_t *last = of->last[search % SEARCHES];
    const int64_t i = last[0] = find(xs, 1, of->sizes[0] - 2, x, last[0]);
    const int64_t j = last[1] = find(ys, 1, of->sizes[1] - 2, y, last[1]);
    out[0] = xs[i], out[1] = xs[i + 1], out[2] = ys[j], out[3] = ys[j + 1];
    for (int s = 0; s < surfaces; s++, heights += first * second) {
        const double *corner = heights + (size_t)i * second + (size_t)j;
        out[4 + s] = corner[0];
        out[4 + surfaces + s] = corner[1];
        out[4 + 2 * surfaces + s] = corner[second];
        out[4 + 3 * surfaces + s] = corner[second + 1];
    }
}
