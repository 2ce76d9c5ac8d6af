# install_shared.sh - shared libraries, from a build without bake and player: what they export, and applications of them.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need cmake
[ "${PARIAN_SANITIZED:-0}" = 0 ] || { echo "skipped: needs a plain build"; exit 77; }
compile=$(command -v cc || command -v gcc || command -v clang) || fail "no C compiler"
generator=$(command -v ninja > /dev/null && echo Ninja || echo "Unix Makefiles")

expect 0 cmake -S "$PARIAN_SOURCE_DIR" -B "$work/build" -G "$generator" -DCMAKE_BUILD_TYPE=Debug -DBUILD_SHARED_LIBS=ON \
    -DPARIAN_WITH_BAKE=OFF -DPARIAN_WITH_PLAYER=OFF -DBUILD_TESTING=OFF -DCMAKE_INSTALL_LIBDIR=lib/deep
expect 0 cmake --build "$work/build" --parallel 2
expect 0 cmake --install "$work/build" --prefix "$work/prefix"
libdir=$work/prefix/lib/deep
expect 0 "$work/prefix/bin/parian-info" --version
[ ! -e "$work/prefix/bin/parian-bake" ] || fail "parian-bake is installed by a build without it"
[ -z "$(find "$work/prefix" -name '*.a')" ] || fail "a static library is installed beside the shared ones"

# The functions that a header declares are those that the library exports: not fewer, not more.
exports_what_is_declared() {
    local library=$libdir/lib$1.so
    shift
    printf '#include <parian/%s>\n' "$@" > "$work/declared.c"
    "$compile" -E "$work/declared.c" -I"$work/prefix/include" |
        awk '/^# /{ own = $3 ~ /\/parian\/('"$(printf '%s|' "$@")"'none)"/ } own' |
        grep -oE '\bparian_[a-z0-9_]+ ?\(' | tr -d ' (' | sort -u > "$work/declared"
    nm -D --defined-only "$library" | awk '{ print $NF }' | sort -u > "$work/exported"
    [ -s "$work/declared" ] || fail "$library: no function was found in $*"
    diff "$work/declared" "$work/exported" > "$out" || fail "$library exports (>) what $* do not declare (<): $(cat "$out")"
}
exports_what_is_declared parian_format format.h result.h
exports_what_is_declared parian_runtime runtime.h
version=$(PKG_CONFIG_PATH=$libdir/pkgconfig pkg-config --modversion parian-runtime)
for library in parian_format parian_runtime; do
    readelf -d "$libdir/lib$library.so" > "$out"
    contains "$out" "[lib$library.so.${version%.*}]"
    [ -f "$libdir/lib$library.so.$version" ] || fail "lib$library.so.$version is missing"
done

# Applications, through CMake and through pkg-config, without what the libraries use themselves.
cat > "$work/app.c" <<'C'
#include <parian/format.h>
#include <parian/runtime.h>

int main(void)
{
    parian_scene *scene = NULL;
    parian_reader *reader = NULL;
    return parian_reader_open(NULL, "absent", NULL, &reader) == PARIAN_E_IO ? parian_scene_open(NULL, "absent", &scene) : 9;
}
C
cat > "$work/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.20)
project(App C)
find_package(Parian REQUIRED)
add_executable(app app.c)
target_link_libraries(app PRIVATE Parian::runtime)
if(COMMAND parian_bake AND NOT TARGET Parian::parian-bake)
  message(STATUS "no parian-bake here")
endif()
CMAKE
expect 0 cmake -S "$work" -B "$work/app" -DParian_DIR="$libdir/cmake/Parian"
contains "$out" "no parian-bake here"
expect 0 cmake --build "$work/app"
expect 2 "$work/app/app"
export PKG_CONFIG_PATH=$libdir/pkgconfig
expect 0 "$compile" "$work/app.c" $(pkg-config --cflags --libs parian-runtime) -Wl,-rpath,"$libdir" -o "$work/plain"
expect 2 "$work/plain"
readelf -d "$work/plain" > "$out"
contains "$out" "libparian_runtime.so"
lacks "$out" libzstd
done_ok
