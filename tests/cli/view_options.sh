# view_options.sh - parian-view's command line: statuses and messages that need no asset.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-view

expect 0 parian-view --help
contains "$out" "--headless"
contains "$out" "Exit status:"
[ -s "$err" ] && fail "--help talks on stderr"
[ "$(awk 'length > 80' "$out" | wc -l)" = 0 ] || fail "--help is wider than 80 columns"
expect 0 parian-view --version
contains "$out" "parian-view "

expect 1 parian-view
one_line "$err"
expect 1 parian-view a.parian b.parian
expect 1 parian-view a.parian --headles
contains "$err" "did you mean '--headless'?"
one_line "$err"

# Arguments are checked before the asset is looked for.
asset=$work/absent.parian
for bad in "--size 10" "--size 0x10" "--size 99999x10" "--size 10x10x" "--exposure bright" "--exposure nan" \
    "--background 1,2" "--background -1,0,0" "--background nan,0,0" "--camera orbit:1" "--camera orbit:1,2,-3" \
    "--camera orbit:a,b" "--light laser:1" "--light point:0,0,0:intensity=-1" "--light point:0,0,0:intensity=nan" \
    "--light directional:0,0,0:irradiance=1" "--view sideways" "--method magic" "--method transfer:samples=3" \
    "--frames 0" "--image picture.jpg" "--roughness 7" "--gl vulkan" "--threads 0"; do
    # shellcheck disable=SC2086
    expect 1 parian-view "$asset" --headless $bad
    one_line "$err"
done
expect 1 parian-view "$asset" --refine 4
contains "$err" "--refine needs --headless"
one_line "$err"
expect 1 parian-view "$asset" --headless --refine 0
expect 1 parian-view "$asset" --timings "$work/t.json"
for later in texture volume:step=1 maps texture:samples=1600,local=401; do
    expect 5 parian-view "$asset" --headless --method "$later"
    one_line "$err"
done

expect 2 parian-view "$asset" --cpu -q
contains "$err" "absent.parian"
one_line "$err"
expect 2 parian-view "$asset" --cpu --lights "$work/absent.json"
contains "$err" "absent.json"
printf '{"lights":[{"type":"point","position":[0,0,0]}]}' > "$work/lights.json"
expect 3 parian-view "$asset" --cpu --lights "$work/lights.json"
contains "$err" "light 0: 'intensity' is missing"
printf 'not an asset' > "$work/text.parian"
expect 3 parian-view "$work/text.parian" --cpu
one_line "$err"
expect 2 parian-view "$work" --cpu
one_line "$err"
done_ok
