#include "table.h"

#include <locale.h>
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

static char *read_text(const char *path) {
    FILE *file = open_file(path);
    if (!file) return NULL;
    size_t length = 0, room = 1 << 16;
    char *text = malloc(room + 1);
    while (text) {
        length += fread(text + length, 1, room - length, file);
        if (length < room) break;
        char *larger = realloc(text, 2 * room + 1);
        if (!larger) free(text);
        text = larger;
        room *= 2;
    }
    if (text && ferror(file)) {
        free(text);
        text = NULL;
    }
    fclose(file);
    if (text) text[length] = 0;
    return text;
}

/* The number at *text, written with a point whatever the host's locale is; moves *text behind it. strtod wants the
   locale's mark, which may be several bytes, and must not see what stands behind the number: a comma may be one. */
static int read_number(const char **text, double *value) {
    char number[512], *end;
    const char *mark = localeconv()->decimal_point, *point;
    const size_t length = strcspn(*text, ",\r\n"), more = strlen(mark);
    if (length == 0 || length + more >= sizeof number) return 0;
    memcpy(number, *text, length);
    number[length] = 0;
    *text += length;
    point = memchr(number, '.', length);
    if (point) {
        const size_t before = (size_t)(point - number);
        memmove(number + before + more, number + before + 1, length - before);
        memcpy(number + before, mark, more);
    }
    *value = strtod(number, &end);
    return *end == 0 && isfinite(*value);
}

static int parse(Table *table, const TableInfo *info, const char *text, const char *path, char *problem, size_t size) {
    size_t header = strlen(info->header);
    if (strncmp(text, info->header, header) != 0 || (text[header] != '\n' && text[header] != '\r')) {
        snprintf(problem, size, "The table %s does not start with the line '%s'.", path, info->header);
        return 1;
    }
    size_t lines = 0;
    for (const char *c = text; *c; c++) lines += *c == '\n';
    table->values = malloc((lines + 1) * (size_t)info->columns * sizeof(double));
    if (!table->values) {
        snprintf(problem, size, "There is not enough memory for the table %s.", path);
        return 1;
    }
    int line = 1;
    for (text += header;;) {
        if (*text == '\r') text++;
        if (*text == '\n') text++, line++;
        if (*text == '\r' || *text == '\n') continue; /* an empty line */
        if (!*text) break;
        double *row = table->values + (size_t)table->rows * (size_t)info->columns;
        int good = read_number(&text, row);
        for (int column = 1; good && column < info->columns; column++) {
            good = *text++ == ',' && read_number(&text, row + column);
        }
        if (!good) {
            snprintf(problem, size, "Line %d of the table %s is not %d numbers separated by commas.", line, path,
                     info->columns);
            return 1;
        }
        if (*text && *text != '\r' && *text != '\n') {
            snprintf(problem, size, "Line %d of the table %s has more than %d numbers.", line, path, info->columns);
            return 1;
        }
        if (table->rows && !(row[0] > row[-info->columns])) {
            snprintf(problem, size, "Line %d of the table %s: its first number, %g, is not greater than the one before.",
                     line, path, row[0]);
            return 1;
        }
        table->rows++;
    }
    if (table->rows < 2) {
        snprintf(problem, size, "The table %s has %d rows; expected at least 2.", path, table->rows);
        return 1;
    }
    return 0;
}

static int table_load(Table *table, const TableInfo *info, const char *resources, char *problem, size_t size) {
    table->columns = info->columns;
    if (!resources || !*resources) {
        snprintf(problem, size, "No fmuResourceLocation was given, but this FMU reads the table resources/%s.", info->file);
        return 1;
    }
    char *path = path_from_uri(resources, info->file);
    char *text = path ? read_text(path) : NULL;
    int failed = 1;
    if (text) failed = parse(table, info, text, path, problem, size);
    else snprintf(problem, size, "The table %s cannot be read.", path ? path : info->file);
    free(text);
    free(path);
    return failed;
}

static void table_free(Table *table) {
    free(table->values);
    table->values = NULL;
}

static uint64_t table_number(const Table *table, uint64_t before) {
    const size_t count = (size_t)table->rows * (size_t)table->columns;
    uint64_t number = before ^ count, bits;
    for (size_t i = 0; i < count; i++) {
        memcpy(&bits, &table->values[i], sizeof bits);
        number = (number ^ bits) * 0x9E3779B97F4A7C15u; /* as in FNV, by words; then high bits reach low ones, too */
        number ^= number >> 32;
    }
    return number;
}

static void table_rows(const Table *table, double time, int64_t *cursor, double *out) {
    const int columns = table->columns;
    int64_t row = *cursor;
    while (row + 2 < table->rows && table->values[(row + 1) * columns] <= time) row++;
    while (row > 0 && table->values[row * columns] > time) row--;
    *cursor = row;
    memcpy(out, table->values + row * columns, 2 * (size_t)columns * sizeof *out);
}
