# dependency_law.sh - who may know whom: formats <- runtime <- player, formats <- bake <- adapters, and nothing else.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
cd "$PARIAN_SOURCE_DIR" || exit 1
compile=${CC:-cc}
compile_cxx=${CXX:-c++}
command -v "$compile" > /dev/null || { echo "skipped: no compiler"; exit 77; }

# forbid TEXT FOLDER... -- PATTERN: no file of the folders has an #include that matches.
forbid() {
    local why=$1 folders=()
    shift
    while [ "$1" != -- ]; do folders+=("$1"); shift; done
    grep -rnE --include='*.[ch]' --include='*.cpp' "^ *# *include *[<\"]($2)" "${folders[@]}" > "$out" 2> /dev/null &&
        fail "$why: $(head -3 "$out")"
    return 0
}

# Between the folders.
forbid "formats knows runtime or bake" formats -- 'runtime/|bake/|parian/runtime\.h'
forbid "runtime knows bake" runtime -- 'bake/|adapters/.*(cgal|openmesh|gltf)'
forbid "bake knows runtime" bake -- 'runtime/|parian/runtime\.h'
forbid "assets knows bake or runtime" assets -- 'bake/|runtime/|parian/runtime\.h'
forbid "the stages know the command line" bake/stages -- 'bake/cli|bake/pipeline'
forbid "the libraries know the tools" formats/container formats/core formats/include runtime/lights runtime/method \
    runtime/shade runtime/gl runtime/cpu runtime/include -- '(formats/)?tool/|(formats/)?inspect/|(runtime/)?player/'

# Foreign libraries.
foreign='CGAL/|OpenMesh/|draco/|tiny_?gltf|stb_|embree|tbb/'
media='[oO]pen(EXR|exr)|png\.h|cjson|GLFW|EGL|epoxy|imgui'
forbid "a mesh library outside the adapters" formats runtime assets bake/stages bake/pipeline bake/cli -- "$foreign"
forbid "a picture, window or JSON library in a library" formats/container formats/core formats/include runtime/include \
    runtime/lights runtime/method runtime/shade runtime/gl runtime/cpu -- "$media"
find . -path ./build -prune -o \( -name '*.cpp' -o -name '*.cc' -o -name '*.hpp' \) -print |
    grep -vE '^\./(bake/adapters|runtime/player/adapters)/|^\./build' > "$out" && fail "C++ outside the adapters: $(head -3 "$out")"

# Every public header alone, as C11 and as C++17; so too the C headers of the adapters.
check_header() {
    printf '#include "%s"\n' "$1" > "$work/alone.c"
    cp "$work/alone.c" "$work/alone.cpp"
    "$compile" -std=c11 -Wall -Wextra -Werror -fsyntax-only -I. -Iformats -Iformats/include -Iruntime/include \
        "$work/alone.c" 2> "$err" || fail "$1 does not compile alone as C11"
    "$compile_cxx" -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I. -Iformats -Iformats/include -Iruntime/include \
        "$work/alone.cpp" 2> "$err" || fail "$1 does not compile alone as C++17"
}
headers=0
for header in formats/include/parian/*.h runtime/include/parian/*.h; do
    check_header "parian/$(basename "$header")"
    grep -q 'extern "C"' "$header" || fail "$header has no extern \"C\""
    headers=$((headers + 1))
done
for header in bake/adapters/*.h runtime/player/adapters/*.h; do
    grep -q 'extern "C"' "$header" || continue # shared by the .cpp files of one adapter only
    check_header "$header"
    headers=$((headers + 1))
done
[ "$headers" -ge 5 ] || fail "only $headers headers were found"

# The built libraries: C, zstd, xxHash and the maths library are all that an application takes in.
format=$PARIAN_BINARY_DIR/formats/libparian_format.a
runtime=$PARIAN_BINARY_DIR/runtime/libparian_runtime.a
bake=$PARIAN_BINARY_DIR/bake/libparian_bake.a
if [ "${PARIAN_SANITIZED:-0}" = 1 ] || [ ! -f "$format" ] || [ ! -f "$runtime" ]; then
    echo "the libraries are not looked at: not built, or built with sanitizers"
    done_ok
fi
printf 'int main(void)\n{\n    return 0;\n}\n' > "$work/application.c"
"$compile" "$work/application.c" -o "$work/application" -Wl,--whole-archive "$runtime" "$format" \
    -Wl,--no-whole-archive -lzstd -lxxhash -lm 2> "$err" || fail "the libraries need more than C, zstd and xxHash"
ldd "$work/application" > "$out"
for library in libstdc++ libGL libEGL libpng libOpenEXR libgmp libcjson; do lacks "$out" "$library"; done

# Libraries do not print, do not exit, and hold no mutable globals.
for library in "$format" "$runtime" "$bake"; do
    [ -f "$library" ] || continue
    nm -u "$library" 2> /dev/null | awk '{ print $2 }' | grep -xE '(__)?(v|f)?printf(_chk)?|puts|putchar|perror|exit|_exit' \
        > "$out" && fail "$(basename "$library") calls $(tr '\n' ' ' < "$out")"
    nm --format=sysv "$library" 2> /dev/null | awk -F'|' '$NF ~ /^\.(bss|data)(\.[a-zA-Z_]|$)/ && $NF !~ /rel\.ro/ { print $1 }' \
        > "$out"
    [ ! -s "$out" ] || fail "$(basename "$library") has mutable globals: $(tr -s ' \n' ' ' < "$out")"
done
done_ok
