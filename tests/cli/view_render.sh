# view_render.sh - parian-view on a baked model: pictures, dumps, timings, cameras, in GL and in C.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-view
need parian-bake

# An octahedron of 40 mm is quick to bake.
printf 'OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n' \
    > "$work/octahedron.off"
asset=$work/octahedron.parian
parian-bake "$work/octahedron.off" --scale 40mm --material marble --atlas 64 --transfer-vertices 300 -q -o "$asset" \
    || fail "the bake failed"

png_size() { od -An -tu1 -j16 -N8 "$1" | awk '{ print ($3 * 256 + $4) "x" ($7 * 256 + $8) }'; }

# Needs neither --image nor --light.
expect 0 parian-view "$asset" --cpu --size 40x30
expect 0 parian-view "$asset" --cpu -q --size 40x30 --image "$work/new/folder/c.png" --dump "$work/c"
[ -s "$err" ] && fail "-q talks"
[ "$(png_size "$work/new/folder/c.png")" = 40x30 ] || fail "wrong size of picture"
expect 0 parian-view "$asset" --cpu --size 40x30 --image "$work/c.exr" --view opaque --exposure -1
[ "$(od -An -tx1 -N4 "$work/c.exr" | tr -d ' ')" = 762f3101 ] || fail "not an OpenEXR picture"

shape() { head -c 128 "$1" | LC_ALL=C tr -cd ' -~' | sed "s/.*'descr': '\(...\)'.*'shape': (\([^)]*\)).*/\1 \2/"; }
count=$(shape "$work/c/texel_area.npy" | sed 's/<f4 \([0-9]*\),$/\1/')
[ "$count" -gt 100 ] || fail "no count of texels: $count"
for name in position normal irradiance radiosity radiosity_local radiosity_global; do
    [ "$(shape "$work/c/texel_$name.npy")" = "<f4 $count, 3" ] || fail "texel_$name.npy has another shape"
done

# Cameras: an orbit with and without a distance, and a file.
printf '{"eye":[0,0,0.2],"target":[0,0,0],"up":[0,1,0],"fov_deg":30}' > "$work/camera.json"
for camera in orbit:30,10 orbit:-400,90,4 orbit:0,-90,20cm "$work/camera.json"; do
    expect 0 parian-view "$asset" --cpu --size 16x16 --camera "$camera"
done
expect 2 parian-view "$asset" --cpu --camera "$work/absent.json"
printf '{"eye":[0,0,0],"target":[0,0,0]}' > "$work/camera.json"
expect 3 parian-view "$asset" --cpu --camera "$work/camera.json"
one_line "$err"

# Every view, no light at all that reaches the body, and lights from a file and an option together.
for view in combined local global irradiance opaque normals charts; do
    expect 0 parian-view "$asset" --cpu --size 16x16 --view "$view"
done
expect 0 parian-view "$asset" --cpu --size 16x16 --light point:0,0,1:intensity=0
printf '{"lights":[{"type":"directional","direction":[0,0,-2],"irradiance":1}]}' > "$work/lights.json"
expect 0 parian-view "$asset" --cpu --size 16x16 --lights "$work/lights.json" --light point:0,0,1:intensity=1 \
    --dump "$work/lit"

# More sets of samples are another mean.
printf '{"lights":[{"type":"environment","radiance":[1,1,1]}]}' > "$work/sky.json"
for sets in 1 3; do
    expect 0 parian-view "$asset" --cpu --size 16x16 --lights "$work/sky.json" --dump "$work/sky$sets" --refine $sets
done
cmp -s "$work/sky1/texel_irradiance.npy" "$work/sky3/texel_irradiance.npy" && fail "--refine changes nothing"

# Timings: the passes ran once a frame.
expect 0 parian-view "$asset" --cpu --size 16x16 --frames 3 --timings "$work/t.json"
contains "$work/t.json" '"frames":	2'
contains "$work/t.json" '"median_ms"'
contains "$work/t.json" '"renderer":	"C evaluation"'

# What cannot be written is exit 2 and leaves nothing.
printf x > "$work/file"
expect 2 parian-view "$asset" --cpu --size 16x16 --dump "$work/file"
one_line "$err"
expect 2 parian-view "$asset" --cpu -q --size 16x16 --image "$work/file/c.png"
one_line "$err"

# No display: the line names the way out.
if [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    expect 4 parian-view "$asset"
    contains "$err" "--headless"
fi

# The same through EGL, where there is one.
if parian-view "$asset" --headless --size 40x30 -q --image "$work/g.png" --dump "$work/g" 2> "$err"; then
    [ "$(png_size "$work/g.png")" = 40x30 ] || fail "wrong size of picture"
    cmp -s "$work/c/texel_position.npy" "$work/g/texel_position.npy" || fail "texels in another order"
    expect 0 parian-view "$asset" --headless --gl es --size 16x16
fi
done_ok
