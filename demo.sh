#!/bin/bash
# demo.sh - installs what is missing, builds, bakes an example model and renders it: build/demo/*.png.
#
# Opens the player at the end when there is a display (PARIAN_NO_WINDOW=1: does not). A second run only
# does what has changed.
set -eu
cd "$(dirname "$0")"
.ci/setup
. .ci/build
started=$SECONDS
release=build/release
demo=build/demo
models=$release/assets/parian-models
montage=$release/assets/parian-montage
bake=$release/bake/parian-bake
view=$release/runtime/parian-view
info=$release/formats/parian-info

say "building the tools"
configure release
build release parian-bake parian-view parian-info parian-models parian-montage
mkdir -p $demo

# fresh TARGET SOURCE...: the target is there and newer than its sources.
fresh() {
    local target=$1 source
    shift
    [ -f "$target" ] || return 1
    for source; do [ "$target" -nt "$source" ] || return 1; done
}

say "models and assets"
fresh $demo/slide.png $models || $models --slide $demo/slide.png
for name in figurine candle cup leaf; do
    fresh $demo/$name.glb $models || $models -o $demo $name
    if ! fresh $demo/$name.parian $demo/$name.glb $bake; then
        begun=$SECONDS
        $bake $demo/$name.glb -o $demo/$name.parian --report $demo/$name-report.json
        echo "$name.parian: baked in $((SECONDS - begun)) s"
    fi
done
$info info $demo/figurine.parian

# OpenGL through EGL where there is one, else the C evaluation.
where=--headless
$view $demo/figurine.parian --headless -q --size 16x16 2> /dev/null || where=--cpu
written=()
# picture NAME ASSET options...: render build/demo/NAME.png unless it is fresh.
picture() {
    local name=$1 asset=$2
    shift 2
    written+=("$name")
    fresh $demo/$name.png $demo/$asset.parian $view demo.sh $demo/slide.png ||
        $view $demo/$asset.parian $where -q "$@" --image $demo/$name.png
}
# beside NAME PICTURE...: pictures side by side.
beside() {
    local name=$1 parts=() part
    shift
    written+=("$name")
    for part; do parts+=("$demo/$part.png"); done
    fresh $demo/$name.png "${parts[@]}" $montage || $montage -o $demo/$name.png "${parts[@]}"
}

say "pictures (parian-view $where)"
look="--size 800x800"
front="--camera orbit:28,14,2.6"
key="--light directional:-0.35,-0.6,-0.75:irradiance=3"
back="--light point:0.03,0.055,-0.09:intensity=0.045 --light directional:0.5,-0.5,-0.6:irradiance=0.06"
slide="--light spot:0.05,0.07,0.2:direction=-0.05,-0.045,-0.2:outer=9:image=$demo/slide.png:intensity=0.2"
picture figurine-front figurine $look $front $key
picture figurine-back figurine $look $front $back
picture figurine-opaque figurine $look $front $key --view opaque
picture figurine-back-opaque figurine $look $front $back --view opaque
picture figurine-local figurine $look $front $key --view local
picture figurine-global figurine $look $front $key --view global
picture figurine-slide figurine $look --camera orbit:14,12,2.6 $slide
picture candle candle $look --camera orbit:20,16,3.4
picture cup cup $look --camera orbit:-30,24,2.7 --light point:-0.05,0.075,-0.11:intensity=0.03 \
    --light directional:0.5,-0.8,-0.7:irradiance=0.8
picture leaf leaf $look --camera orbit:25,42,2.6 --light directional:0.3,0.8,-0.4:irradiance=2 \
    --light directional:0.4,-1,-0.5:irradiance=1
beside opaque-translucent figurine-opaque figurine-front figurine-back-opaque figurine-back
beside local-global-combined figurine-local figurine-global figurine-front
beside figurine figurine-front figurine-back

say "written to $demo in $((SECONDS - started)) s"
for name in "${written[@]}"; do echo "  $demo/$name.png"; done
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] && [ -z "${PARIAN_NO_WINDOW:-}" ]; then
    say "opening the player (close its window to end)"
    $view $demo/figurine.parian || echo "the player could not open a window; the pictures above are complete"
fi
