# view_window.sh - parian-view's window under Xvfb with mouse and keys of xdotool: panel, orbit, a dragged light,
# help, views, reloading. What is seen is compared by statistics of pixels, what was computed by counters.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-view
need parian-bake
need picture_statistics
# The driver of a window unloads itself before leaks are looked for, and what it kept can no longer be named. The
# player's own leaks are looked for in its other tests.
[ "${PARIAN_SANITIZED:-0}" = 0 ] || export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"
. "$PARIAN_SOURCE_DIR/tests/support/window_support.sh"

printf 'OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n' \
    > "$work/octahedron.off"
bake() {
    parian-bake "$work/octahedron.off" --scale 40mm --material "$1" --atlas 64 --transfer-vertices 300 -q -o "$2" \
        || fail "the bake failed"
}
bake marble "$work/live.parian"
bake ketchup "$work/other.parian"

# The picture lies right of the panel, 336 wide: 384 x 360 pixels.
statistics() { picture_statistics "$pictures/$1.png" 336 0 384 360 ${2:+"$pictures/$2.png"}; }
# differs A B LEAST MOST: the share of the picture's pixels that differ.
differs() {
    local share
    share=$(statistics "$1" "$2" | awk '{ print $5 }')
    awk -v s="$share" -v a="$3" -v b="$4" 'BEGIN { exit !(s >= a && s <= b) }' ||
        fail "$1 and $2 differ in $share of the picture, expected $3 to $4"
}

start_display 720x360
start_window "$work/live.parian" --size 720x360 --light point:0.012,0.018,0.05:intensity=0.005
shoot first

# Stored: a light body in the middle of a dark picture, and a panel that is dark with light text.
statistics first | awk '{ exit !($1 > 25 && $1 < 140 && $1 >= $3 && $4 > 25) }' || fail "not the picture: $(statistics first)"
picture_statistics "$pictures/first.png" 4 4 300 300 | awk '{ exit !($1 > 8 && $1 < 80 && $3 > $1 && $4 > 15) }' ||
    fail "not the panel: $(picture_statistics "$pictures/first.png" 4 4 300 300)"

# Nothing happens: the same picture. Orbit: another one, without light being computed anew.
shoot again
differs first again 0 0.001
drag 1 360 330 390 335 420 340
shoot orbit
differs first orbit 0.05 0.9
key f
key g
shoot framed
# The panel goes, the picture takes the window.
key F1
shoot alone
picture_statistics "$pictures/alone.png" 4 4 300 300 "$pictures/framed.png" | awk '{ exit !($5 > 0.05) }' || fail "the panel stays"
key F1
shoot back
differs framed back 0 0.02
# Help is a box over the picture, and on stdout.
key h
shoot help
differs back help 0.1 1
contains "$log" "frame the bodies"
key h
# Views: charts are coloured, the flat atlas is neither the surface nor empty.
key 7
shoot charts
differs back charts 0.05 1
key 0
shoot atlas
differs charts atlas 0.1 1
key 1
stop_window
runs() { sed -n "s/.*pass $1 ran \([0-9]*\) times/\1/p" "$log"; }
[ "$(runs shadow)" = 1 ] || fail "an orbit relit: $(cat "$log")"
# At rest E took in more sets of samples, no more than 64 (with sanitizers a set is too slow to be taken).
[ "${PARIAN_SANITIZED:-0}" = 1 ] || [ "$(runs irradiance)" -gt 1 ] || fail "nothing was refined"
[ "$(runs irradiance)" -le 64 ] || fail "$(runs irradiance) sets"
[ "$(runs shade)" -ge 5 ] || fail "the orbit was not shaded"

# A light is dragged by its ring: here it is at the middle of the picture, a little above; then turned.
saved=0
start_window "$work/live.parian" --size 720x360 --light point:0,0,0.05:intensity=0.005 --camera orbit:0,0,4
shoot lit
drag 1 528 180 560 150 600 120
shoot dragged
differs lit dragged 0.05 0.9
drag 3 400 300 440 300 480 300
shoot turned
differs dragged turned 0.05 0.9
# Off by its key: dark.
key o
shoot dark
statistics dark | awk '{ exit !($1 < 40 && $4 < 12) }' || fail "a light that is off shines: $(statistics dark)"
key o
stop_window
[ "$(runs shadow)" -ge 5 ] || fail "the lights were not computed: $(cat "$log")"

# The file changes on disk: damaged, it is one line and the old picture stays; whole, it is shown.
saved=0
start_window "$work/live.parian" --size 720x360 --light point:0.012,0.018,0.05:intensity=0.005
key g
shoot before
head -c 20000 "$work/other.parian" > "$work/live.parian"
wait_for "rule"
shoot damaged
differs before damaged 0 0.15 # the line over the picture's lower edge
[ "$(grep -c 'warning:.*rule' "$log")" = 1 ] || fail "a damaged file is not one line: $(cat "$log")"
cp "$work/other.parian" "$work/new.parian"
mv "$work/new.parian" "$work/live.parian"
wait_for "again"
shoot reloaded
differs before reloaded 0.05 0.9
statistics reloaded | awk '{ exit !($1 > 1.5 * $3) }' || fail "ketchup is not red: $(statistics reloaded)"
stop_window
[ -z "$(find "$pictures" -name 'imgui.ini')" ] || fail "something is remembered on disk"

# A window that cannot open its asset says so and ends.
expect 3 parian-view "$work/octahedron.off"
one_line "$err"
expect 2 parian-view "$work/absent.parian"
one_line "$err"
done_ok
