/* machine.c - asks the system what it is.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/machine.h"

#include <limits.h>
#include <sched.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cjson/cJSON.h>

/* The text behind a separator on the first line of a file that begins with a key, without quotes.
 */
static bool read_value(const char *path, const char *key, char separator,
                       char value[PARIAN_MACHINE_TEXT_MAX])
{
    char line[512];
    bool found = false;
    FILE *file = fopen(path, "r");
    while (file && !found && fgets(line, sizeof line, file)) {
        const char *at = strncmp(line, key, strlen(key)) == 0 ? strchr(line, separator) : NULL;
        if (at) {
            at += 1 + strspn(at + 1, " \"");
            snprintf(value, PARIAN_MACHINE_TEXT_MAX, "%.*s", (int)strcspn(at, "\"\n"), at);
            found = true;
        }
    }
    if (file) {
        fclose(file);
    }
    return found;
}

static void read_system(char text[PARIAN_MACHINE_TEXT_MAX])
{
    char distribution[PARIAN_MACHINE_TEXT_MAX] = "unknown";
    struct utsname name;
    read_value("/etc/os-release", "PRETTY_NAME", '=', distribution);
    bool known = uname(&name) == 0;
    snprintf(text, PARIAN_MACHINE_TEXT_MAX, "%.80s, %.20s %.40s", distribution,
             known ? name.sysname : "unknown", known ? name.release : "");
}

void parian_machine_read(parian_machine *machine)
{
    cpu_set_t set;
    *machine = (parian_machine){.processor = "unknown", .compiler = __VERSION__};
    read_value("/proc/cpuinfo", "model name", ':', machine->processor);
    read_system(machine->system);
    machine->cores = sched_getaffinity(0, sizeof set, &set) == 0 ? (uint32_t)CPU_COUNT(&set) : 1;
    long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
    machine->memory_bytes = pages > 0 && size > 0 ? (uint64_t)pages * (uint64_t)size : 0;
}

static bool list_has(const cJSON *list, const char *text)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        if (strcmp(item->valuestring, text) == 0) {
            return true;
        }
    }
    return false;
}

/* Names of the files of loaded shared libraries, each once. */
static void add_libraries(cJSON *list)
{
    char line[PATH_MAX + 128];
    FILE *file = fopen("/proc/self/maps", "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *name = strrchr(line, '/');
        line[strcspn(line, "\n")] = 0;
        if (name && strstr(name, ".so") && !list_has(list, name + 1)) {
            cJSON_AddItemToArray(list, cJSON_CreateString(name + 1));
        }
    }
    if (file) {
        fclose(file);
    }
}

cJSON *parian_machine_json(const parian_machine *machine)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "processor", machine->processor);
    cJSON_AddNumberToObject(object, "cores", machine->cores);
    cJSON_AddNumberToObject(object, "memory_bytes", (double)machine->memory_bytes);
    cJSON_AddStringToObject(object, "system", machine->system);
    cJSON_AddStringToObject(object, "compiler", machine->compiler);
    cJSON *libraries = cJSON_AddArrayToObject(object, "libraries");
    if (libraries) {
        add_libraries(libraries);
    }
    return object;
}
