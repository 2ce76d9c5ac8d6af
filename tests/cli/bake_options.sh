# bake_options.sh - parian-bake's command line: statuses, messages, configuration, presets.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-bake

ply=$work/tetrahedron.off
write_tetrahedron "$ply"

expect 0 parian-bake --help
contains "$out" "--transfer-vertices"
contains "$out" "parian-bake figurine.glb"
lacks "$out" "--samples"
expect 0 parian-bake --version
expect 1 parian-bake
expect 1 parian-bake "$ply"                         # no output
expect 1 parian-bake "$ply" -o "$work/a.parian"     # no unit
contains "$err" "--scale"
one_line "$err"
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale -5mm
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --unit mm
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --kernel 8
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --kernel 17
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --atlas 1000000
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --threshold nan
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --no-local --no-global
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --hierarchy sometimes
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --hierarchy on --form paper
contains "$err" "--form parian"
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --hierarchy on --threshold 0
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --material granite9
contains "$err" "--list-materials"
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --material nobody=marble
expect 1 parian-bake "$ply" -o "$work/a.parian" --frobnicate
expect 5 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --samples 100
expect 5 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --max-error 0.01
expect 1 parian-bake reference "$ply" # reference_command.sh tries it
expect 2 parian-bake "$work/absent.ply" --scale 50mm -o "$work/a.parian"
contains "$err" "absent.ply"
one_line "$err"
expect 2 parian-bake "$ply" --scale 50mm -o "$work/tetrahedron.off/below/a.parian"
contains "$err" "expected a folder"
one_line "$err"
expect 2 parian-bake "$ply" --scale 50mm -o "$work"
expect 2 parian-bake "$ply" --scale 50mm -o /dev/full
one_line "$err"
expect 1 parian-bake "$ply" --scale 50mm -o "$ply"
contains "$err" "is the input"
expect 1 parian-bake "$ply" --scale 50mm -o -
expect 2 parian-bake "$ply" --scale 50mm -o "$work/a.parian" --report "$ply/report.json"
expect 2 parian-bake "$ply" --scale 50mm -o "$work/a.parian" --dump "$ply"
expect 2 parian-bake "$work/absent.ply" --scale 50mm -o "$work/new/folder/a.parian"
ln -s /dev/zero "$work/zero.stl"
mkfifo "$work/pipe.ply"
for file in zero.stl pipe.ply; do
    expect 2 timeout 20 parian-bake "$work/$file" --scale 50mm -o "$work/a.parian"
    contains "$err" "a file was expected"
done
[ ! -e "$work/new" ] || fail "a failed run left a folder"
expect 5 parian-bake "$work/model.fbx" --scale 50mm -o "$work/a.parian"
[ ! -e "$work/a.parian" ] || fail "a failed run left an asset"

expect 0 parian-bake --list-materials
contains "$out" "Marble"
contains "$out" "Skimmilk"
expect 0 parian-bake --print-config --quality preview --kernel 5
contains "$out" '"kernel":	5'
contains "$out" '"atlas":	256'

cat > "$work/medium.json" <<'JSON'
{"name": "soap", "sigma_s_prime": [2, 2.5, 3], "sigma_a": 0.01, "eta": 1.4, "unit": "1/mm", "source": "test"}
JSON
expect 0 parian-bake "$ply" --scale 20mm --material "$work/medium.json" --transfer-vertices 300 --atlas 64 \
    -o "$work/out/here/soap.parian" --report "$work/out/there/soap.json" -MD --dump "$work/dump"
contains "$work/out/there/soap.json" '"soap"'
contains "$work/out/here/soap.parian.d" "medium.json"
[ -s "$work/dump/texel_position.npy" ] || fail "no texel_position.npy"
[ -s "$work/dump/body0_atlas.png" ] || fail "no atlas picture"
expect 0 parian-info validate "$work/out/here/soap.parian"

# An error of a stage names the file, a warning the body.
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' > "$work/flat.off"
expect 3 parian-bake "$work/flat.off" --scale 20mm --material marble -o "$work/a.parian"
contains "$err" "$work/flat.off: "
one_line "$err"

# Names in a .gltf are URIs; the dependency file names the files.
printf '%s' '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"buffers":[{"uri":"four%20corners.bin","byteLength":60}]}' > "$work/corners.gltf"
zero='\0\0\0\0' one='\0\0\200\77'
printf "$zero$zero$zero$one$zero$zero$zero$one$zero$zero$zero$one" > "$work/four corners.bin"
printf '\0\2\1\0\1\3\1\2\3\0\3\2' >> "$work/four corners.bin"
expect 0 parian-bake "$work/corners.gltf" --scale 20mm --transfer-vertices 300 --atlas 64 --material marble \
    -o "$work/corners.parian" -MF "$work/corners.d"
contains "$work/corners.d" 'four\ corners.bin'

echo '{"sigma_s_prime": [2, -1, 3], "sigma_a": 0.01}' > "$work/bad.json"
expect 3 parian-bake "$ply" --scale 20mm --material "$work/bad.json" -o "$work/a.parian"
one_line "$err"
echo '{"sigma_s": 2, "sigma_a": 0.01, "g": 1.5, "unit": "1/mm"}' > "$work/bad.json"
expect 3 parian-bake "$ply" --scale 20mm --material "$work/bad.json" -o "$work/a.parian"
contains "$err" '"g" is 1.5'
done_ok
