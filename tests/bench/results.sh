#!/bin/bash
# results.sh - measures what docs/results.md states, and prints its tables as Markdown.
#
#   tests/bench/results.sh BUILD [SECTION...]     sections: bake accuracy local shapes transport gl
#
# BUILD is a release build folder. Works on generated models; where ../shared/data is present its meshes are
# measured too. Takes some minutes on an idle machine.
set -eu
[ $# -ge 1 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 1; }
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
shift
sections=${*:-bake accuracy local shapes transport gl}
PATH=$build/bake:$build/formats:$build/runtime:$build/assets:$build/tests:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
shared=$source_dir/../shared/data/meshes
parian-models -q -o "$work" figurine candle cup leaf
parian-models -q --slide "$work/slide.png"

directional=directional:0.3,-0.5,-0.8:irradiance=1
point=point:0.06,0.05,0.06:intensity=0.01
slide="spot:0,0.02,0.12:direction=0,-0.166,-1:outer=17:inner=16:image=$work/slide.png:intensity=0.02"

# field NAME FILE: the first number that follows "NAME": in a JSON report.
field() { sed -n "s/.*\"$1\":[[:space:]]*\([-+0-9.e]*\).*/\1/p" "$2" | head -1; }

# source_of NAME: path and scale options of a model.
source_of() {
    case $1 in
    figurine | candle | cup | leaf) echo "$work/$1.glb --scale 50mm" ;;
    *) echo "$shared/$1.ply --scale 50mm" ;;
    esac
}
have() { case $1 in figurine | candle | cup | leaf) true ;; *) [ -f "$shared/$1.ply" ] ;; esac; }

# bake NAME MATERIAL options...: $work/a.parian and $work/a.json
bake() {
    local input
    input=$(source_of "$1")
    # shellcheck disable=SC2086
    parian-bake $input -q --material "$2" -o "$work/a.parian" --report "$work/a.json" "${@:3}"
}

# One row an error line: | label | light | L2 | energy | p99.9 | smallest |
error_rows() {
    awk -v label="$1" '/ L2 / {
        light = /directional:/ ? "directional" : /point:/ ? "point" : "slide, 8 squares"
        for (i = 1; i <= NF; i++) {
            if ($i == "L2") l2 = $(i+1)*100 "/" $(i+2)*100 "/" $(i+3)*100
            if ($i == "energy") en = $(i+1) "/" $(i+2) "/" $(i+3)
            if ($i == "p99.9") p = $(i+1) "/" $(i+2) "/" $(i+3)
            if ($i == "smallest") s = $(i+1)
        }
        printf "| %s | %s | %s | %s | %s | %s |\n", label, light, l2, en, p, s
    }'
}

section_bake() {
    printf '### Seconds of a bake\n\n| model | triangles kept | stage seconds | all s | peak MB | file MB | factors a channel |\n|---|---|---|---|---|---|---|\n'
    for name in figurine bunny_mid_75k horse_97k happy_buddha_100k igea_269k; do
        have $name || continue
        bake $name marble
        local stages=
        sed -n '/"seconds":/,/}/p' "$work/a.json" > "$work/seconds"
        for s in surface "transfer mesh" atlas texels plan detail global blend local; do
            stages="$stages$s $(printf '%.2f' "$(field "$s" "$work/seconds")"), "
        done
        stages="import $(printf '%.2f' "$(field import_seconds "$work/a.json")"), ${stages}write $(printf '%.2f' "$(field write_seconds "$work/a.json")")"
        printf '| %s | %s | %s | %.1f | %.0f | %.0f | %.1f M |\n' "$name" \
            "$(field triangles "$work/a.json")" "$stages" "$(field total_seconds "$work/a.json")" \
            "$(awk "BEGIN{print $(field peak_memory_bytes "$work/a.json")/1e6}")" \
            "$(awk "BEGIN{print $(field file_size "$work/a.json")/1e6}")" \
            "$(awk "BEGIN{print $(field factors_per_channel "$work/a.json")/1e6}")"
    done
    echo
}

section_accuracy() {
    printf '### Error of B against quadrature (50 mm, defaults, 1,000 receivers)\n\n| model, medium | light | L2 %% R/G/B | energy ratio | p99.9 over mean | smallest B |\n|---|---|---|---|---|---|\n'
    for name in figurine candle cup leaf bunny_mid_75k horse_97k happy_buddha_100k igea_269k; do
        have $name || continue
        for medium in marble skimmilk; do
            bake $name $medium
            bench_asset_error "$work/a.parian" $directional $point "$slide" | error_rows "$name, $medium"
        done
    done
    echo
}

section_local() {
    printf '### Forms of the local part (figurine, marble, 50 mm)\n\n| form | bytes | load s | product ms | filter ms | L2 %% directional | L2 %% slide |\n|---|---|---|---|---|---|---|\n'
    local form
    for form in "--local rebuilt" "--local f16" "--local u8" "--local split" "--local split --kernel 15" \
        "--local rebuilt --kernel 5" "--local rebuilt --kernel 9" "--no-local" "--form paper" \
        "--local rebuilt --threshold-absolute 1e-5"; do
        # shellcheck disable=SC2086
        bake figurine marble --force-local $form 2> /dev/null || bake figurine marble $form
        bench_asset_error "$work/a.parian" $directional "$slide" > "$work/errors"
        awk -v form="$form" '
            FNR == 1 { bytes = $1; load_s = $4 }
            / L2 / { for (i = 1; i <= NF; i++) { if ($i == "L2") v = $(i+1)*100 "/" $(i+2)*100 "/" $(i+3)*100
                       if ($i == "product") product = $(i+1); if ($i == "filter") filter = $(i+1) }
                     if (/directional:/) d = v; else s = v }
            END { printf "| `%s` | %s MB | %s | %s | %s | %s | %s |\n", form, bytes, load_s, product, filter, d, s }' "$work/errors"
    done
    echo
}

section_shapes() {
    printf '### Size against error (figurine, marble, 50 mm)\n\n| vertices | threshold | file MB | product ms | L2 %% directional | L2 %% slide |\n|---|---|---|---|---|---|\n'
    for vertices in 2500 5000 10000; do
        for threshold in 0.002 0.01 0.05; do
            bake figurine marble --transfer-vertices $vertices --threshold $threshold
            bench_asset_error "$work/a.parian" $directional "$slide" > "$work/errors"
            awk -v v=$vertices -v t=$threshold '
                FNR == 1 { bytes = $1 }
                / L2 / { for (i = 1; i <= NF; i++) { if ($i == "L2") e = $(i+1)*100 "/" $(i+2)*100 "/" $(i+3)*100
                           if ($i == "product") product = $(i+1) }
                         if (/directional:/) d = e; else s = e }
                END { printf "| %s | %s | %s | %s | %s | %s |\n", v, t, bytes, product, d, s }' "$work/errors"
        done
    done
    echo
}

section_transport() {
    printf '### Transport, and its products against the memory bandwidth (bench_transport)\n\n```\n'
    bench_transport marble 50 rebuilt
    printf '```\n\n'
}

section_gl() {
    printf '### Passes of the renderer (figurine, marble, 50 mm, defaults)\n\n```\n'
    bake figurine marble
    for flavour in "--cpu" "--gl core" "--gl es"; do
        # shellcheck disable=SC2086
        parian-view "$work/a.parian" --headless -q $flavour --light $directional --size 1024x768 --frames 5 \
            --timings "$work/t.json" --image "$work/t.png" || continue
        awk -v flavour="$flavour" '
            /"renderer"/ { gsub(/.*:[ \t]*"|",?$/, ""); name = $0 }
            /"name"/ { gsub(/.*:[ \t]*"|",?$/, ""); pass = $0 }
            /"median_ms"/ { gsub(/[^0-9.]/, ""); line = line "  " pass " " $0 }
            END { print flavour ", " name ":" line }' "$work/t.json"
    done
    printf '```\n\n'
}

for section in $sections; do section_"$section"; done
