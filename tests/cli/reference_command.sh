# reference_command.sh - parian-bake reference: statuses, messages, outputs and their shapes, interruption.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-bake

reference() { parian-bake reference "$@"; }
# shape FILE.npy: what its header says.
shape() { head -c 128 "$1" | tail -c +11 | sed -n "s/.*'shape': (\([^)]*\)).*/\1/p"; }
has_shape() { [ "$(shape "$1")" = "$2" ] || fail "$1 has shape ($(shape "$1")), expected ($2)"; }
# npy FILE DESCR SHAPE: a header of 128 bytes; the elements come from stdin.
npy() {
    { printf "\223NUMPY\001\000v\000%-117s\n" "{'descr': '$2', 'fortran_order': False, 'shape': ($3), }"; cat; } > "$1"
}

model=$work/tetrahedron.off
write_tetrahedron "$model"
light=directional:-1,-1,-1:irradiance=1
base=("$model" --scale 20mm --material marble)
quick=(--receivers 12 --samples 512)

expect 0 reference --help
contains "$out" "Models over the surface:"
contains "$out" "Path tracing:"
contains "$out" "Examples:"
expect 0 reference --version
contains "$out" "parian-bake "
expect 0 parian-bake --help
contains "$out" "  reference  ground truth"

# Mistakes are found before any work, in one line.
mistake() {
    local text=$1
    shift
    expect 1 reference "$@" -o "$work/none"
    one_line "$err"
    contains "$err" "$text"
}
mistake "no INPUT" --light $light
mistake "several given" "$model" "$model" --light $light
mistake "exclude each other" "${base[@]}" --unit mm --light $light
mistake "not one of" "${base[@]}" --model magic --light $light
mistake "is for path" "${base[@]}" --light $light --walk forward
mistake "is for path" "${base[@]}" --light $light --standard-error 0.01
mistake "is for path" "${base[@]}" --light $light --patch 1mm
mistake "is for directional and pbd" "${base[@]}" --light $light --normalise off
mistake "--fdr is for" "${base[@]}" --light $light --model path --fdr fit
mistake "is for planar" "${base[@]}" --light $light --thickness 1mm
mistake "takes no INPUT" "$model" --model planar --material marble
mistake "needs one --material" --model planar
mistake "takes no lights" --model planar --material marble --light $light
mistake "outside of" "${base[@]}" --light $light --receivers 0
mistake "outside of" "${base[@]}" --light $light --samples 0
mistake "give --lights FILE or --light" "${base[@]}"
mistake "--list-materials" --model planar --material granite9
mistake "glow" "${base[@]}" --light glow:1,2,3
expect 1 reference "${base[@]}" --light $light
contains "$err" "-o DIR"
one_line "$err"
expect 1 reference "$model" --light $light -o "$work/none" # no unit
contains "$err" "--scale"
one_line "$err"
expect 2 reference "${base[@]}" --lights "$work/absent.json" -o "$work/none"
expect 2 reference "$work/absent.ply" --scale 20mm --light $light -o "$work/none"
expect 2 reference "${base[@]}" --light $light -o "$model"
one_line "$err"
expect 2 reference "${base[@]}" --light $light --receivers absent.npy -o "$work/none"
echo '{"lights":[]}' > "$work/none.json"
expect 3 reference "${base[@]}" --lights "$work/none.json" -o "$work/none"
one_line "$err"
[ ! -e "$work/none" ] || fail "a failed run left a folder"

# Damaged arrays.
printf 'no array' > "$work/bad.npy"
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
one_line "$err"
printf '%24s' '' | npy "$work/bad.npy" '<f8' '2, 3'
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
contains "$err" "ends after 3 elements"
one_line "$err"
printf '\0\0\300\177\0\0\0\0\0\0\0\0' | npy "$work/bad.npy" '<f4' '1, 3'
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
contains "$err" "not finite"
printf '\0\0\0\0\345\234\352\102' | cat - <(printf '%16s' '' | tr ' ' '\0') | npy "$work/bad.npy" '<f8' '1, 3' # 2.3e14 m
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
contains "$err" "beyond 1e12 m"
one_line "$err"
printf '%48s' '' | npy "$work/bad.npy" '<c8' '2, 3'
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
contains "$err" "elements are '<c8', expected"
printf '%32s' '' | npy "$work/bad.npy" '<f4' '2, 4'
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
contains "$err" "[n][3]"
printf '%48s' '' | npy "$work/bad.npy" '>f8' '2, 3'
expect 3 reference "${base[@]}" --light $light --receivers "$work/bad.npy" -o "$work/none"
expect 3 reference "${base[@]}" --light $light --model path --field "$work/bad.npy" -o "$work/none"
printf '%32s' '' | tr ' ' '\0' | npy "$work/flat.npy" '<f4' '2, 1, 4'
expect 3 reference "${base[@]}" --light $light --model path --field "$work/flat.npy" -o "$work/none"
contains "$err" "expected 2 to"
one_line "$err"
expect 3 reference "${base[@]}" --light $light --model path --field "$work/flat.npy" -q -o "$work/none"
[ "$(wc -l < "$err")" = 1 ] || fail "-q: more than one line"

printf '\0\0\200\177%.0s' 1 2 3 4 5 6 7 8 | tr '\177\200' '\140\255' | npy "$work/flat.npy" '<f4' '2, 2, 2' # 1e20
expect 3 reference "${base[@]}" --light $light --model path --field "$work/flat.npy" -o "$work/none"
contains "$err" "flat.npy: node 0"
one_line "$err"
printf '\0\0\200\100%.0s' 1 2 3 | npy "$work/far.npy" '<f4' '1, 3' # 4 m away from 20 mm
expect 0 reference "${base[@]}" --samples 64 --light $light --receivers "$work/far.npy" -o "$work/far"
contains "$err" "were moved by up to"

# Every BSSRDF model: arrays, summary, the same bytes for any threads.
for name in dipole dipole-flux directional pbd; do
    expect 0 reference "${base[@]}" "${quick[@]}" --light $light --model $name -o "$work/$name"
    for array in position normal irradiance radiosity standard_error; do
        has_shape "$work/$name/receiver_$array.npy" "12, 3"
    done
    has_shape "$work/$name/receiver_area.npy" "12,"
    contains "$work/$name/summary.json" "\"model\":	\"$name\""
    for key in energy_W in out absorbed samples seconds relative_standard_error normalisation seed tool; do
        contains "$work/$name/summary.json" "\"$key\""
    done
    [ ! -e "$work/$name/receiver_radiosity_unscattered.npy" ] || fail "$name writes unscattered light"
done
cmp -s "$work/dipole/receiver_radiosity.npy" "$work/dipole-flux/receiver_radiosity.npy" && fail "the gradient changes nothing"
expect 0 reference "${base[@]}" "${quick[@]}" --light $light --threads 3 --seed 0 -q -o "$work/threads"
[ ! -s "$err" ] || fail "-q talks"
cmp "$work/dipole/receiver_radiosity.npy" "$work/threads/receiver_radiosity.npy" || fail "threads change the bytes"
expect 0 reference "${base[@]}" "${quick[@]}" --light $light --seed 1 -o "$work/seed"
cmp -s "$work/dipole/receiver_radiosity.npy" "$work/seed/receiver_radiosity.npy" && fail "the seed changes nothing"
expect 0 reference "${base[@]}" "${quick[@]}" --light $light --fdr fit -o "$work/fit"
contains "$work/fit/summary.json" '"fdr":	"fit"'
expect 0 reference "${base[@]}" "${quick[@]}" --light $light --model directional --normalise off -o "$work/off"
cmp -s "$work/directional/receiver_radiosity.npy" "$work/off/receiver_radiosity.npy" && fail "--normalise changes nothing"

# Points of one's own; every type of light from a file.
printf '\0\0\0\0\0\0\0\0\0\0\0\0\n\327\243;\n\327\243;\0\0\0\0' | npy "$work/points.npy" '<f4' '2, 3'
cat > "$work/lights.json" <<'JSON'
{"lights":[{"type":"point","position":[0,0.05,0],"intensity":[0.1,0.1,0.1]},
{"type":"directional","direction":[-1,0,-1],"irradiance":[1,1,1]},
{"type":"spot","position":[0.05,0,0.05],"direction":[-1,0,-1],"intensity":[0.1,0.1,0.1],"inner_deg":10,"outer_deg":20},
{"type":"rect","center":[0,0,0.05],"axis_u":[0.01,0,0],"axis_v":[0,-0.01,0],"radiance":[1,1,1]},
{"type":"environment","radiance":[1,1,1]}]}
JSON
expect 0 reference "${base[@]}" --keep-origin --receivers "$work/points.npy" --samples 256 --lights "$work/lights.json" \
    --light $light -o "$work/new/points"
has_shape "$work/new/points/receiver_radiosity.npy" "2, 3"
contains "$work/new/points/summary.json" '"lights":	6'
contains "$work/new/points/summary.json" '"out":	[null, null, null]'

# Path tracing, with and without a field.
expect 0 reference "${base[@]}" --model path --receivers 4 --samples 64 --light $light -o "$work/path"
has_shape "$work/path/receiver_radiosity_unscattered.npy" "4, 3"
for key in roulette_added roulette_removed lost scattering_events; do contains "$work/path/summary.json" "\"$key\""; done
[ ! -e "$work/path/checkpoint.bin" ] || fail "a finished run left its checkpoint"
expect 0 reference "${base[@]}" "${quick[@]}" --light $light -o "$work/path" # a quadrature in the same folder
[ ! -e "$work/path/receiver_radiosity_unscattered.npy" ] || fail "an array of an earlier run is left"
printf '\0\0\200?%.0s' 1 2 3 4 5 6 7 8 | npy "$work/one.npy" '<f4' '2, 2, 2'
expect 0 reference "${base[@]}" --model path --receivers 4 --samples 64 --light $light --field "$work/one.npy" \
    --walk adjoint -o "$work/field"
contains "$work/field/summary.json" '"field":	true'

# Tables of planes.
expect 0 reference --model planar --material skin1 --samples 2000 -o "$work/half"
[ "$(head -1 "$work/half/half_space_normal.csv")" = "channel,radius_m,lit_side_per_m2,lit_side_error" ] || fail "its header"
[ ! -e "$work/half/slab_diffuse.csv" ] || fail "a slab without a thickness"
expect 0 reference --model planar --material skin1 --thickness 1mm --samples 2000 -o "$work/slab"
rows=$(($(wc -l < "$work/slab/slab_diffuse.csv") - 1))
has_shape "$work/slab/slab_diffuse.npy" "3, $((rows / 3)), 5"
contains "$work/slab/summary.json" '"slab_normal"'
contains "$work/slab/summary.json" '"far_side"'

# Ctrl-C: 130, one line, nothing but the checkpoint of a path.
interrupt() {
    local folder=$1
    shift
    parian-bake reference "$@" -q -o "$folder" > "$out" 2> "$err" &
    local process=$!
    sleep 1.5
    kill -INT $process
    wait $process
    [ $? = 130 ] || fail "'$*' was not interrupted: $(ls "$folder" 2> /dev/null)"
    one_line "$err"
    [ -z "$(ls "$folder" 2> /dev/null | grep -v '^checkpoint.bin$')" ] || fail "partial output: $(ls "$folder")"
}
interrupt "$work/stopped" "${base[@]}" --light $light --samples 400000000 --receivers 5000
[ ! -e "$work/stopped" ] || fail "an interrupted quadrature left its folder"
interrupt "$work/stopped" --model planar --material skimmilk --samples 400000000
interrupt "$work/walk" "${base[@]}" --model path --light $light --samples 400000000 --receivers 50
done_ok
