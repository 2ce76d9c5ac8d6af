# measure_command.sh - parian-measure end to end: tables, cache, maps, pictures, mistakes; hard cases.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-measure
need parian-bake

printf 'OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n' \
    > "$work/octahedron.off"
printf '{"lights":[{"type":"directional","direction":[-0.5,-0.6,-0.7],"irradiance":[3,2,1]}]}' > "$work/sun.json"
printf '{"lights":[{"type":"point","position":[0.05,0.05,0.1],"intensity":0.01}]}' > "$work/lamp.json"
bake='--atlas 64 --transfer-vertices 300'
measure() { parian-measure "$work/octahedron.off" --scale 40mm --material marble --backend cpu --receivers 60 --relight-seconds 0.05 "$@"; }

# Two bakes under two light sets: a row for each bake, set and channel, with the columns of the contract.
expect 0 measure --bake "$bake" --bake "$bake --form paper" --lights "$work/sun.json" --lights "$work/lamp.json" \
    -o "$work/new/a" -q
[ -s "$err" ] && fail "-q talks"
contains "$out" "form paper"
contains "$out" "within 10 ms"
[ "$(awk 'length($0) > 110' "$out" | wc -l)" = 0 ] || fail "lines that are too long"
csv=$work/new/a/results.csv
[ "$(head -1 "$csv" | cut -d, -f1-13)" = asset,method,lights,reference,channel,l1,l2,energy_ratio,p999,minimum,relight_ms,asset_bytes,bake_s ] ||
    fail "columns: $(head -1 "$csv")"
[ "$(wc -l < "$csv")" = 13 ] || fail "$(wc -l < "$csv") lines in results.csv, expected 13"
[ "$(tail -n +2 "$csv" | cut -d, -f1-5 | sort -u | wc -l)" = 12 ] || fail "rows that cannot be told apart"
# A plain body at a coarse setting: B within 6 % (L2), its energy within 4 %, nothing negative; a relight takes time.
grep -v 'form paper' "$csv" | awk -F, 'NR > 1 && !($7 < 0.06 && $7 > 1e-5 && $8 > 0.96 && $8 < 1.04 && $10 > -1e-3 && $11 > 0 && $12 > 1000 && $13 > 0) { print; bad = 1 } END { exit bad }' \
    > "$work/bad" || fail "errors out of bounds: $(cat "$work/bad")"
for file in results.json results.md speed-vs-error.gp size-vs-error.gp bake-vs-error.gp; do
    [ -s "$work/new/a/$file" ] || fail "$file is missing"
done
if command -v gnuplot > /dev/null; then
    [ -s "$work/new/a/speed-vs-error.svg" ] && [ -s "$work/new/a/speed-vs-error.png" ] || fail "no plot"
fi
for key in processor cores memory_bytes system libraries renderer command date pass_ms equal_time equal_error; do
    contains "$work/new/a/results.json" "\"$key\""
done
contains "$work/new/a/results.json" '"from_cache":	false'

# The cache gives the same numbers, in another folder, and again when a file of it is damaged.
numbers() { tail -n +2 "$1" | cut -d, -f1-10,12-; }
expect 0 measure --bake "$bake" --bake "$bake --form paper" --lights "$work/sun.json" --lights "$work/lamp.json" \
    -o "$work/b" --cache "$work/new/a/cache" -q
[ "$(numbers "$csv")" = "$(numbers "$work/b/results.csv")" ] || fail "the cache gives other numbers"
contains "$work/b/results.json" '"from_cache":	true'
lacks "$work/b/results.json" '"from_cache":	false'
for file in "$work"/new/a/cache/truth-*; do printf damage | dd of="$file" bs=1 seek=200 conv=notrunc 2> /dev/null; done
expect 0 measure --bake "$bake" --lights "$work/sun.json" -o "$work/c" --cache "$work/new/a/cache" -q --threads 3
[ "$(numbers "$work/c/results.csv")" = "$(numbers "$csv" | grep ',sun,' | grep -v paper)" ] || fail "other numbers after damage"

# What a graphics driver keeps until the end cannot be told from a leak of ours once the driver is unloaded.
backend=core
[ "${PARIAN_SANITIZED:-0}" = 0 ] || backend=cpu

# An asset as it is, with its own surface; maps, pictures, models that are named.
asset=$(ls "$work"/new/a/cache/bake-*.parian | head -1)
cp "$asset" "$work/given.parian"
expect 0 parian-measure "$work/given.parian" --lights "$work/lamp.json" -o "$work/d" -q --relight-seconds 0.05 --receivers 40 --map-receivers 80 \
    --images --picture-size 48 --backend $backend --reference directional --reference-samples 4000
[ "$(wc -l < "$work/d/results.csv")" = 4 ] || fail "rows of an asset"
contains "$work/d/results.csv" ",directional,"
contains "$work/d/results.json" '"surface":	"asset"'
[ "$(wc -l < "$work/d/images.csv")" = 2 ] || fail "images.csv"
for file in atlas.png atlas.exr object.png object.exr; do
    [ -s "$work/d/maps/given.parian-lamp-$file" ] || fail "no map: $file"
done
expect 0 parian-measure "$work/given.parian" --lights "$work/lamp.json" -o "$work/e" -q --relight-seconds 0.05 --receivers 6 --backend cpu \
    --reference path --standard-error 0.2
contains "$work/e/results.csv" ",path,"

# Mistakes: one line, the status of the contract, and nothing left behind.
mistake() {
    local status=$1
    shift
    expect "$status" "$@" -q
    one_line "$err"
    [ ! -e "$work/f" ] || fail "'$*' left a folder"
}
mistake 1 measure -o "$work/f"
mistake 1 measure --lights "$work/sun.json"
mistake 1 parian-measure --lights "$work/sun.json" -o "$work/f"
mistake 1 measure --lights "$work/sun.json" -o "$work/f" --bake '-o x.parian'
mistake 1 measure --lights "$work/sun.json" -o "$work/f" --bake '--quality best'
mistake 1 measure --lights "$work/sun.json" -o "$work/f" --bake "$bake" --bake "$bake"
mistake 1 measure --lights "$work/sun.json" -o "$work/f" --methods 'transfer:samples=3'
mistake 1 measure --lights "$work/sun.json" -o "$work/f" --methods 'light'
mistake 5 measure --lights "$work/sun.json" -o "$work/f" --methods 'transfer texture:samples=400'
contains "$err" texture
mistake 1 measure --lights "$work/sun.json" -o "$work/f" --reference lensch
mistake 2 parian-measure "$work/absent.ply" --lights "$work/sun.json" -o "$work/f"
mistake 2 measure --lights "$work/absent.json" -o "$work/f"
printf '{"lights":[]}' > "$work/dark.json"
mistake 3 measure --lights "$work/dark.json" -o "$work/f"
printf '{"lights":[{"type":"sun"}]}' > "$work/broken.json"
mistake 3 measure --lights "$work/broken.json" -o "$work/f"
printf 'OFF\n3 1 0\n0 0' > "$work/cut.off"
expect 3 parian-measure "$work/cut.off" --unit mm --lights "$work/sun.json" -o "$work/g" --backend $backend -q
one_line "$err"
[ ! -e "$work/g/results.csv" ] || fail "results of a failed run"
head -c 1000 "$work/given.parian" > "$work/cut.parian"
expect 3 parian-measure "$work/cut.parian" --lights "$work/sun.json" -o "$work/g" --backend $backend -q
one_line "$err"
printf x > "$work/file"
expect 2 measure --lights "$work/sun.json" -o "$work/file" -q
one_line "$err"

# Hard cases: the contract's columns, quoted text, an unknown name, and two quick ones.
expect 0 parian-measure hard-cases --list
[ "$(grep -cx 'eta-below-one\|open-mesh\|non-manifold\|scale-0.1mm\|g-0.995' "$out")" = 5 ] || fail "hard cases are missing"
expect 1 parian-measure hard-cases -o "$work/f" --cases sound-sphere,no-case -q
one_line "$err"
[ ! -e "$work/f" ] || fail "an unknown hard case left a folder"
expect 1 parian-measure hard-cases -q
expect 1 parian-measure hard-cases -o "$work/f" more -q
expect 0 parian-measure hard-cases -o "$work/hard" --cases path-below-texel,path-above-object-path -q
[ -s "$err" ] && fail "-q talks"
[ "$(head -1 "$work/hard/hard-cases.csv")" = case,finite,energy_ratio,error,expected,verdict ] || fail "columns of hard cases"
grep -q '^path-below-texel,yes,.*,pass$' "$work/hard/hard-cases.csv" || fail "path-below-texel: $(cat "$work/hard/hard-cases.csv")"
grep -q '^path-above-object-path,yes,.*,short$' "$work/hard/hard-cases.csv" || fail "path-above-object-path: $(cat "$work/hard/hard-cases.csv")"
contains "$work/hard/hard-cases.md" "1 of 2 cases fall short"

expect 0 parian-measure --help
contains "$out" "--map-receivers"
expect 0 parian-measure hard-cases --help
expect 0 parian-measure --version
done_ok
