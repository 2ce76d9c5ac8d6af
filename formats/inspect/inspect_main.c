/* inspect_main.c - parian-info: picks the command, parses its options, runs it on every asset.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "inspect/inspect.h"
#include "tool/session.h"

enum { EXIT_DIFFERENT = 7, ARGUMENT_MAX = 512 };

typedef parian_result (*asset_command)(const parian_env *env, const inspect_options *options,
                                       const char *path);

typedef struct command_entry {
    const char *name, *brief, *tool, *usage, *summary, *epilogue;
    asset_command run; /* NULL: compare */
    bool takes_json, takes_chunk, takes_tolerance, one_asset, takes_codec;
} command_entry;

static const command_entry commands[] = {
    {"info", "what an asset holds", "parian-info info", "ASSET... [--json]",
     "Prints what an asset holds: bodies with their media, the mean free path against extent and "
     "texel size, counts, bytes by part, estimated GPU memory, the plan, provenance.",
     NULL, inspect_info, true, false, false, false, false},
    {"chunks", "its arrays", "parian-info chunks", "ASSET... [--json]",
     "Lists the arrays of an asset: name, element, shape, codec, bytes.", NULL, inspect_chunks,
     true, false, false, false, false},
    {"validate", "whether every byte follows the rules of the format", "parian-info validate",
     "ASSET... [--json]",
     "Checks every byte of an asset against the rules of the format. A violation ends with exit "
     "status 3 and one "
     "line that says which rule, what was found and where.",
     NULL, inspect_validate, true, false, false, false, false},
    {"export", "one array as .npy or .csv", "parian-info export",
     "ASSET --chunk NAME -o FILE.npy|FILE.csv", "Writes one array of an asset to a file.",
     "Example:\n  parian-info export bunny.parian --chunk body0/texel.area -o area.npy",
     inspect_export, false, true, false, true, false},
    {"compare", "whether two assets hold the same", "parian-info compare",
     "A B [--tolerance T] [--json]",
     "Compares two assets array by array. Exit status 7 when they differ.",
     "Indices are compared exactly. With a tolerance, texts (names, plan, provenance) do not "
     "count.",
     NULL, true, false, true, false, false},
    {"repack", "the same arrays with another compression", "parian-info repack",
     "ASSET -o OUT.parian [--level N] [--codec CODEC]",
     "Writes an asset anew with another compression. Every array stays the same; chunks that this "
     "version does not know are copied as they are stored, and the minor version of the format "
     "stays. OUT may be the asset itself.",
     "Examples:\n  parian-info repack bunny.parian -o small.parian --level 19\n"
     "  parian-info repack bunny.parian -o mapped.parian --codec raw",
     inspect_repack, true, false, false, true, true},
};
enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

static const char *const later_commands[] = {"atlas", "plot", "explain"};

static const command_entry *find_command(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(commands[i].name, name) == 0) {
            return &commands[i];
        }
    }
    return NULL;
}

static bool is_later(const char *name)
{
    for (size_t i = 0; i < sizeof later_commands / sizeof *later_commands; i++) {
        if (strcmp(later_commands[i], name) == 0) {
            return true;
        }
    }
    return false;
}

/* ---- options ------------------------------------------------------------------------------------
 */

static void add_repack_options(inspect_options *options, parian_option *table, size_t *count)
{
    options->level = 9;
    table[(*count)++] = (parian_option){.name = "-o",
                                        .alias = "--output",
                                        .kind = PARIAN_OPTION_STRING,
                                        .value = &options->output,
                                        .argument = "FILE",
                                        .help = "The asset to write."};
    table[(*count)++] =
        (parian_option){.name = "--level",
                        .kind = PARIAN_OPTION_COUNT,
                        .value = &options->level,
                        .argument = "N",
                        .minimum = 1,
                        .maximum = 19,
                        .help = "Level of zstd (9; parian-bake writes with 3). Higher is smaller "
                                "and slower to write; reading takes as long."};
    table[(*count)++] = (parian_option){
        .name = "--codec",
        .kind = PARIAN_OPTION_CHOICE,
        .value = &options->codec,
        .choices = "default|keep|raw|zstd|shuffle|delta",
        .help = "How arrays are stored: as parian-bake does (default); each as in ASSET; without "
                "compression, so that they can be mapped; zstd alone; bytes by significance, then "
                "zstd; differences (reals: shuffle), then zstd."};
}

static parian_result parse_command(const command_entry *entry, int argc, char **argv,
                                   inspect_options *options)
{
    parian_option table[4];
    size_t count = 0;
    if (entry->takes_json) {
        table[count++] = (parian_option){.name = "--json",
                                         .kind = PARIAN_OPTION_FLAG,
                                         .value = &options->json,
                                         .help = "Print JSON: one document for each asset."};
    }
    if (entry->takes_chunk) {
        table[count++] = (parian_option){.name = "--chunk",
                                         .kind = PARIAN_OPTION_STRING,
                                         .value = &options->chunk,
                                         .argument = "NAME",
                                         .help = "The array, by the name that chunks lists."};
        table[count++] =
            (parian_option){.name = "-o",
                            .alias = "--output",
                            .kind = PARIAN_OPTION_STRING,
                            .value = &options->output,
                            .argument = "FILE",
                            .help = "The file to write, .npy or .csv; - is csv to stdout."};
    }
    if (entry->takes_tolerance) {
        table[count++] = (parian_option){
            .name = "--tolerance",
            .kind = PARIAN_OPTION_NUMBER,
            .value = &options->tolerance,
            .argument = "T",
            .minimum = 0,
            .maximum = 1e30,
            .given = &options->tolerance_given,
            .help = "Values may differ by T times the array's largest absolute value (0: "
                    "not at all)."};
    }
    if (entry->takes_codec) {
        add_repack_options(options, table, &count);
    }
    const parian_command command = {.tool = entry->tool,
                                    .usage = entry->usage,
                                    .summary = entry->summary,
                                    .epilogue = entry->epilogue,
                                    .options = table,
                                    .option_count = count};
    return parian_options_parse(&command, &options->common, &options->assets, argc, argv, 1);
}

static parian_result refuse(const command_entry *entry, const char *what)
{
    fprintf(stderr, "parian-info: error: %s %s (see %s --help)\n", entry->name, what, entry->tool);
    return PARIAN_E_ARGUMENT;
}

static parian_result check_arguments(const command_entry *entry, const inspect_options *options)
{
    if (!entry->run && options->assets.count != 2) {
        return refuse(entry, "needs two assets");
    }
    if (options->assets.count == 0) {
        return refuse(entry, "needs an asset");
    }
    if (entry->one_asset && options->assets.count != 1) {
        return refuse(entry, "takes one asset");
    }
    if (entry->takes_chunk && (!options->chunk || !options->output)) {
        return refuse(entry, "needs --chunk NAME and -o FILE");
    }
    if (entry->takes_codec && (!options->output || strcmp(options->output, "-") == 0)) {
        return refuse(entry, "needs -o FILE, which cannot be stdout");
    }
    return PARIAN_OK;
}

/* ---- running ------------------------------------------------------------------------------------
 */

static int run_compare(parian_session *session, const inspect_options *options)
{
    bool different = false;
    parian_result result = inspect_compare(parian_session_env(session), options, &different);
    int status = parian_session_exit(session, result);
    return result == PARIAN_OK && different ? EXIT_DIFFERENT : status;
}

static int run_assets(parian_session *session, const command_entry *entry,
                      const inspect_options *options)
{
    int worst = 0;
    for (size_t i = 0; i < options->assets.count; i++) {
        parian_result result =
            entry->run(parian_session_env(session), options, options->assets.item[i]);
        int status = parian_session_exit(session, result);
        worst = status > worst ? status : worst;
    }
    return worst;
}

static int run(const command_entry *entry, const inspect_options *options)
{
    parian_session *session;
    parian_result result = parian_session_create("parian-info", &options->common, &session);
    if (result != PARIAN_OK) {
        return parian_result_exit_status(result);
    }
    int status = entry->run ? run_assets(session, entry, options) : run_compare(session, options);
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == 0) {
        fprintf(stderr, "parian-info: error: cannot write to stdout\n");
        status = parian_result_exit_status(PARIAN_E_IO);
    }
    parian_session_destroy(session);
    return status;
}

static int run_command(const command_entry *entry, int argc, char **argv)
{
    static inspect_options options;
    parian_result result = parse_command(entry, argc, argv, &options);
    if (result == PARIAN_OK && (options.common.help || options.common.version)) {
        return 0;
    }
    if (result == PARIAN_OK) {
        result = check_arguments(entry, &options);
    }
    return result == PARIAN_OK ? run(entry, &options) : parian_result_exit_status(result);
}

/* Without a command: --help and --version, or one line that says what is wrong. */
static int run_without_command(int argc, char **argv)
{
    static parian_common_options common;
    static parian_string_list words;
    parian_subcommand list[COMMAND_COUNT];
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        list[i] = (parian_subcommand){commands[i].name, commands[i].brief};
    }
    const parian_command command = {.tool = "parian-info",
                                    .usage = "COMMAND ASSET... [options]",
                                    .summary =
                                        "Inspects, validates, exports and compares .parian assets.",
                                    .commands = list,
                                    .command_count = COMMAND_COUNT};
    parian_result result = parian_options_parse(&command, &common, &words, argc, argv, 1);
    if (result != PARIAN_OK) {
        return parian_result_exit_status(result);
    }
    if (common.help || common.version) {
        return 0;
    }
    fprintf(stderr, "parian-info: error: %s%s%s (see parian-info --help)\n",
            words.count > 0 ? "unknown command '" : "a command is needed",
            words.count > 0 ? words.item[0] : "", words.count > 0 ? "'" : "");
    return parian_result_exit_status(PARIAN_E_ARGUMENT);
}

/* The command is the first word that names one; options may stand before it. */
int main(int argc, char **argv)
{
    char *rest[ARGUMENT_MAX + 1];
    for (int i = 1; i < argc && argc <= ARGUMENT_MAX; i++) {
        const command_entry *entry = find_command(argv[i]);
        if (entry) {
            memcpy(rest, argv, (size_t)i * sizeof *rest);
            memcpy(rest + i, argv + i + 1, (size_t)(argc - i) * sizeof *rest);
            return run_command(entry, argc - 1, rest);
        }
        if (is_later(argv[i])) {
            fprintf(stderr,
                    "parian-info: error: command '%s' is not supported by this version (see "
                    "parian-info --help)\n",
                    argv[i]);
            return parian_result_exit_status(PARIAN_E_UNSUPPORTED);
        }
    }
    return run_without_command(argc, argv);
}
