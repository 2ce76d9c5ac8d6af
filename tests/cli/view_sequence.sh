# view_sequence.sh - parian-view's turntables, camera paths, several views, atlases and errors, in C and in GL.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-view
need parian-bake

printf 'OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n' \
    > "$work/octahedron.off"
asset=$work/octahedron.parian
parian-bake "$work/octahedron.off" --scale 40mm --material marble --atlas 64 --transfer-vertices 300 -q -o "$asset" \
    || fail "the bake failed"
count() { find "$1" -type f | wc -l; }

# What does not go together is told before any work.
absent=$work/absent.parian
for bad in "--turntable 4" "--turntable 4 --image a.png" "--turntable 4 --camera-path p.json --image a%d.png" \
    "--turntable 4 --frames 3 --image a%d.png" "--turntable 0 --image a%d.png" "--turntable 4 --image a%x.png" \
    "--turntable 2 --timings t.json --image a%d.png" "--view local,opaque --cpu --image a.png" "--view local,opaque" \
    "--view local,sideways --cpu" "--view error --cpu"; do
    # shellcheck disable=SC2086
    expect 1 parian-view "$absent" $bad
    one_line "$err"
done

# A turn: as many files as frames, all different, the opposite ones of a symmetric body's outline of one size.
expect 0 parian-view "$asset" --cpu --size 32x32 --turntable 5 --image "$work/turn/t-%04d.png"
[ "$(count "$work/turn")" = 5 ] || fail "expected 5 pictures, got $(count "$work/turn")"
[ "$(cat "$work"/turn/*.png | wc -c)" -gt 2000 ] || fail "the pictures are empty"
[ "$(sha256sum "$work"/turn/*.png | awk '{ print $1 }' | sort -u | wc -l)" = 5 ] || fail "two frames are alike"
expect 0 parian-view "$asset" --cpu --size 32x32 --image "$work/still.png"
cmp -s "$work/still.png" "$work/turn/t-0000.png" || fail "a turn does not begin where a still picture is taken"

# A path: the first and the last frame are the keyframes.
printf '{"keyframes":[{"eye":[0,0,0.2]},{"eye":[0.15,0.05,0.15],"time":2},{"eye":[0.2,0,0],"time":3}],"frames":4}' \
    > "$work/path.json"
printf '{"eye":[0.2,0,0],"target":[0,0,0]}' > "$work/last.json"
expect 0 parian-view "$asset" --cpu --size 24x24 --camera orbit:0,0,20cm --camera-path "$work/path.json" \
    --image "$work/path/p%d.exr"
[ "$(count "$work/path")" = 4 ] || fail "expected 4 pictures"
expect 0 parian-view "$asset" --cpu --size 24x24 --camera "$work/last.json" --image "$work/last.exr"
cmp -s "$work/last.exr" "$work/path/p3.exr" || fail "a path does not end at its last keyframe"
expect 0 parian-view "$asset" --cpu --size 24x24 --camera-path "$work/path.json" --frames 2 --image "$work/two/p%d.png"
[ "$(count "$work/two")" = 2 ] || fail "--frames does not say how many"
printf '{"keyframes":[{"eye":[0,0,1]}]}' > "$work/path.json"
expect 3 parian-view "$asset" --cpu --camera-path "$work/path.json" --image "$work/no%d.png"
one_line "$err"
expect 2 parian-view "$asset" --cpu --camera-path "$work/absent.json" --image "$work/no%d.png"
[ ! -e "$work/no0.png" ] || fail "a failed run wrote a picture"

# Several views at once, and the atlases; a view alone is the same picture.
expect 0 parian-view "$asset" --cpu --size 48x32 --view opaque,radiosity,atlas-irradiance,atlas-charts \
    --image "$work/views/%s.png"
[ "$(count "$work/views")" = 4 ] || fail "expected 4 views"
expect 0 parian-view "$asset" --cpu --size 48x32 --view atlas-irradiance --image "$work/atlas.png"
cmp -s "$work/atlas.png" "$work/views/atlas-irradiance.png" || fail "a view differs among several"

# Errors: of itself none, of a brighter light as much as it is brighter.
light=point:0,0.05,0.2:intensity=0.1
expect 0 parian-view "$asset" --cpu --size 32x32 --light $light --dump "$work/truth" --image "$work/truth.exr"
expect 0 parian-view "$asset" --cpu --size 32x32 --light $light --view error --reference "$work/truth" \
    --image "$work/error.png"
contains "$err" "relative error (L2) against $work/truth: 0.0000"
expect 0 parian-view "$asset" --cpu --size 32x32 --light ${light/0.1/0.12} --view error --reference "$work/truth"
contains "$err" "0.2000"
expect 0 parian-view "$asset" --cpu --size 32x32 --light ${light/0.1/0.12} --view error --reference "$work/truth.exr"
contains "$err" "0.2000"
expect 1 parian-view "$asset" --cpu --size 16x32 --light $light --view error --reference "$work/truth.exr"
contains "$err" "32 x 32"
one_line "$err"
expect 2 parian-view "$asset" --cpu --view error --reference "$work/absent"
one_line "$err"

# Ctrl-C ends a long sequence with 130; what is there is whole.
parian-view "$asset" --cpu -q --size 64x64 --turntable 100000 --image "$work/long/l%05d.png" 2> "$err" &
long=$!
for _ in $(seq 100); do [ -e "$work/long/l00001.png" ] && break; sleep 0.1; done
kill -INT $long
wait $long
[ $? = 130 ] || fail "an interrupted sequence does not end with 130"
find "$work/long" -type f ! -name 'l?????.png' | grep -q . && fail "a temporary file is left"
last=$(find "$work/long" -name '*.png' | sort | tail -1)
[ "$(tail -c 8 "$last" | od -An -tx1 | tr -d ' \n')" = 49454e44ae426082 ] || fail "the last picture is cut off"

# The same through EGL, where there is one.
if parian-view "$asset" --headless --size 32x32 --turntable 3 -q --image "$work/gl/t%d.png" 2> "$err"; then
    [ "$(count "$work/gl")" = 3 ] || fail "expected 3 pictures from GL"
    expect 0 parian-view "$asset" --headless --light $light --view error,atlas-radiosity --reference "$work/truth" \
        --size 32x32 --image "$work/gl/%s.png"
    grep -qE 'truth: 0\.000[0-9]' "$err" || fail "GL and C differ: $(cat "$err")"
fi
done_ok
