# info_commands.sh - parian-info on a small asset: what it prints, what it refuses, exit statuses.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-info
asset=$work/tiny.parian
cp "$PARIAN_SOURCE_DIR/tests/golden/tiny_1_0.parian" "$asset" && chmod u+w "$asset"
json() { command -v python3 > /dev/null || return 0; python3 -c "import json,sys; d=json.load(open('$out')); $1" || fail "json: $1"; }

# Help, version, usage.
expect 0 parian-info --help
contains "$out" "validate"
contains "$out" "repack"
expect 0 parian-info --version
contains "$out" "parian-info "
expect 0 parian-info export --help
contains "$out" "--chunk"
expect 1 parian-info
one_line "$err"
expect 1 parian-info frobnicate "$asset"
one_line "$err"
expect 1 parian-info info
expect 1 parian-info compare "$asset"
expect 1 parian-info export "$asset" --chunk body0/texel.area
expect 1 parian-info export "$asset" --chunk no.such -o "$work/x.npy"
expect 1 parian-info info --nonsense "$asset"
for later in atlas plot explain; do
    expect 5 parian-info $later "$asset" -o "$work/x.svg"
    one_line "$err"
done

# info and chunks.
expect 0 parian-info info "$asset"
for text in "Tiny Marble" "mean free path" "13 x 13" "made by hand" "GPU memory" "throughput factors" "floor"; do
    contains "$out" "$text"
done
awk 'NR > 1 && length($0) > 80 { exit 1 }' "$out" || fail "info prints more than 80 columns"
expect 0 parian-info info --json "$asset"
json "assert d['bodies'][0]['local_form'] == 'f16' and len(d['bodies']) == 2 and d['file_bytes'] > 0"
json "assert abs(d['bodies'][0]['medium']['mean_free_path_m'][0] - 1 / 2002) < 1e-9"
expect 0 parian-info chunks "$asset"
contains "$out" "body0/local.kernel_f16"
expect 0 parian-info chunks --json "$asset"
json "n = [c['name'] for c in d]; assert len(n) == len(set(n)) and 'scene.lights' in n; assert all('shape' in c for c in d)"

# validate.
expect 0 parian-info validate "$asset"
expect 3 parian-info validate "$PARIAN_SOURCE_DIR/CMakeLists.txt"
contains "$err" "rule 102"
expect 2 parian-info validate "$work/missing.parian"
expect 2 parian-info info "$work"
expect 3 parian-info -q validate "$asset" "$work/missing.parian" "$PARIAN_SOURCE_DIR/CMakeLists.txt"
size=$(stat -c %s "$asset")
head -c $((size - 1)) "$asset" > "$work/short.parian"
expect 3 parian-info -q validate "$work/short.parian"
one_line "$err"
contains "$err" "rule 106"
for place in 9 50 80 4000 $((size - 5)); do
    cp "$asset" "$work/flip.parian"
    printf '\x5a' | dd of="$work/flip.parian" bs=1 seek="$place" conv=notrunc 2> /dev/null
    for command in info validate; do
        expect 3 parian-info -q $command "$work/flip.parian"
        one_line "$err"
        contains "$err" "rule "
    done
done
expect 3 parian-info validate --json "$work/flip.parian"
json "assert d['valid'] is False and 'rule' in d['finding']"

# export.
expect 0 parian-info export "$asset" --chunk body0/texel.area -o "$work/new/folder/area.npy"
[ "$(stat -c %s "$work/new/folder/area.npy")" -ge $((25 * 4)) ] || fail "the npy is too short"
expect 0 parian-info export "$asset" --chunk body0/triangle.vertex -o -
printf '0,1,2\n0,2,3\n' | cmp - "$out" || fail "csv: $(cat "$out")"
expect 0 parian-info export "$asset" --chunk surrounding.reflectance -o "$work/r.csv"
printf '0.5\n0.5\n0.5\n' | cmp - "$work/r.csv" || fail "csv of one column"
expect 5 parian-info export "$asset" --chunk body0/texel.area -o "$work/area.png"
[ ! -e "$work/area.png" ] || fail "a refused export left a file"
parian-info chunks "$asset" | awk 'NR > 1 { print $1 }' > "$work/names"
while read -r name; do expect 0 parian-info export "$asset" --chunk "$name" -o "$work/all.npy"; done < "$work/names"

# compare.
cp "$asset" "$work/same.parian"
expect 0 parian-info compare "$asset" "$work/same.parian"
other=$PARIAN_SOURCE_DIR/tests/golden/tiny_area_1_0.parian
expect 7 parian-info compare "$asset" "$other"
contains "$out" "body0/texel.area"
lacks "$out" "body1"
expect 7 parian-info compare "$asset" "$other" --tolerance 1e-5
expect 0 parian-info compare "$asset" "$other" --tolerance 1e-3
expect 7 parian-info compare --json "$asset" "$other"
json "assert d['different'] and [c['name'] for c in d['chunks'] if c['verdict'] == 'different'] == ['body0/texel.area']"
expect 3 parian-info compare "$asset" "$work/short.parian"
done_ok
