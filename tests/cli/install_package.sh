# install_package.sh - an installed tree is complete: tools, headers, and a package that an application links.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need cmake
[ "${PARIAN_SANITIZED:-0}" = 0 ] || { echo "skipped: needs a plain build"; exit 77; }

expect 0 cmake --install "$PARIAN_BINARY_DIR" --prefix "$work/prefix"
for tool in parian-info parian-view parian-bake; do
    if command -v $tool > /dev/null; then
        expect 0 "$work/prefix/bin/$tool" --version
    fi
done
mkdir "$work/app"
cat > "$work/app/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.20)
project(App C)
find_package(Parian REQUIRED)
add_executable(app app.c)
target_link_libraries(app PRIVATE Parian::runtime)
CMAKE
cat > "$work/app/app.c" <<'C'
#include <parian/format.h>
#include <parian/runtime.h>
#include <stdio.h>

int main(int argc, char **argv)
{
    parian_scene *scene = NULL;
    parian_result result = parian_scene_open(NULL, argc > 1 ? argv[1] : "absent.parian", &scene);
    puts(parian_result_text(result));
    parian_scene_close(scene);
    return parian_result_exit_status(result);
}
C
expect 0 cmake -S "$work/app" -B "$work/app/build" -DCMAKE_PREFIX_PATH="$work/prefix"
expect 0 cmake --build "$work/app/build"
expect 2 "$work/app/build/app"
contains "$out" "input or output failed"
done_ok
