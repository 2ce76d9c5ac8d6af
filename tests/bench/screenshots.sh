#!/bin/bash
# screenshots.sh - makes the pictures of docs/player.md, with mouse and keys on a display of its own.
#
#   tests/bench/screenshots.sh BUILD [OUT]     OUT: docs/pictures
#
# BUILD is a release build folder. Needs Xvfb and xdotool; takes a minute.
set -u
[ $# -ge 1 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 1; }
PARIAN_SOURCE_DIR=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
to=${2:-$PARIAN_SOURCE_DIR/docs/pictures}
mkdir -p "$to"
PATH=$build/bake:$build/runtime:$build/assets:$build/tests:$PATH
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
. "$PARIAN_SOURCE_DIR/tests/support/window_support.sh"

models figurine
parian-bake "$work/models/figurine.glb" --atlas 256 --transfer-vertices 4000 -q -o "$work/figurine.parian" \
    || fail "the bake failed"

# The window with its panel, after an orbit.
start_display 730x610
start_window "$work/figurine.parian" --size 730x610
drag 1 500 300 530 305 560 310
sleep 2 # a coarse picture is refined
shoot panel
stop_window
trap 'kill "$display_pid" 2> /dev/null; wait 2> /dev/null; rm -rf "$work"' EXIT

# Views side by side.
views=combined,opaque,irradiance,radiosity,normals,atlas-radiosity
parian-view "$work/figurine.parian" --headless -q --size 144x180 --view $views --image "$work/view-%s.png" || fail "no views"
# shellcheck disable=SC2046
parian-montage --columns 3 -o "$pictures/views.png" $(printf "$work/view-%s.png " ${views//,/ }) || fail "no montage"

# The error against quadrature of the same BSSRDF at receivers on the same surface.
light=directional:-0.4,-0.6,-0.7:irradiance=3
printf '{"lights":[{"type":"directional","direction":[-0.4,-0.6,-0.7],"irradiance":3}]}' > "$work/lights.json"
parian-bake reference "$work/figurine.parian" --lights "$work/lights.json" --model dipole --receivers 2000 --samples 1000 \
    -q -o "$work/truth" || fail "no reference"
parian-view "$work/figurine.parian" --headless --size 290x290 --light $light --view combined,error --reference "$work/truth" \
    --image "$work/error-%s.png" || fail "no error view"
parian-montage --columns 2 -o "$pictures/error.png" "$work/error-combined.png" "$work/error-error.png" || fail "no montage"

for name in panel views error; do
    cp "$pictures/$name.png" "$to/player-$name.png"
    [ "$(wc -c < "$to/player-$name.png")" -lt 150000 ] || echo "player-$name.png is larger than 150 kB"
done
ls -l "$to"/player-*.png
