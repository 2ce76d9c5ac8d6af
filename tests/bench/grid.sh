#!/bin/bash
# grid.sh - models x media x sizes against ground truth: the tables of docs/results.md as CSV and Markdown.
#
#   tests/bench/grid.sh BUILD OUT quadrature   every model, medium and size against quadrature: grid.csv, grid.md,
#                                              grid_summary.md
#   tests/bench/grid.sh BUILD OUT path         two models and two media at 50 mm against path tracing: path.csv, path.md
#   tests/bench/grid.sh BUILD OUT settings     one body under many settings: plots of error against ms, bytes, seconds
#
# BUILD is a release build folder. A cell that OUT holds already is not measured again; truths stay in OUT/cache for runs that bake anew. MODELS, MEDIA, SIZES,
# RECEIVERS and STANDARD_ERROR in the environment choose others than the defaults below. Generated models are made
# here; scans are taken from ../shared/data/meshes, and left out, which is said, where they are absent.
set -eu
[ $# -eq 3 ] || { sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 1; }
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
out=$2
what=$3
PATH=$build/bake:$build/formats:$build/runtime:$build/assets:$build/tests/measure:$PATH
shared=$source_dir/../shared/data/meshes
mkdir -p "$out/models"
out=$(cd "$out" && pwd)
parian-models -q -o "$out/models" figurine cup candle

# One light that casts shadows, from the upper left behind the viewer; and the same with a sky.
cat > "$out/sun.json" << 'JSON'
{"lights":[{"type":"directional","direction":[0.3,-0.5,-0.8],"irradiance":[1,1,1]}]}
JSON
cat > "$out/sky.json" << 'JSON'
{"lights":[{"type":"directional","direction":[0.3,-0.5,-0.8],"irradiance":[1,1,1]},
           {"type":"environment","radiance":[0.1,0.1,0.1]}]}
JSON

source_of() {
    if [ -f "$out/models/$1.glb" ]; then echo "$out/models/$1.glb"; else echo "$shared/$1.ply"; fi
}

# cell FOLDER MODEL MEDIUM SIZE options...: one run of parian-measure.
cell() {
    local folder=$out/$1 input
    input=$(source_of "$2")
    [ ! -s "$folder/results.csv" ] || return 0
    [ -f "$input" ] || { echo "left out: $2 is not here" >&2; return 0; }
    echo "$1" >&2
    parian-measure -q "$input" --scale "$4" --material "$3" --cache "$out/cache" -o "$folder" "${@:5}" > /dev/null ||
        echo "failed: $1" >&2
    find "$out/cache" -name 'bake-*' -delete
}

# merge NAME FOLDER...: the cells' rows under one line of names, with model, medium and size in front.
merge() {
    local name=$1 first=1 folder
    shift
    for folder in "$@"; do
        [ -s "$folder/results.csv" ] || continue
        [ $first = 0 ] || sed -n '1s/^/model_name,medium,size,/p' "$folder/results.csv"
        first=0
        sed "1d;s|^|$(basename "$folder"),|" "$folder/results.csv"
    done > "$out/$name.csv"
}

# table NAME: a Markdown row for each cell and bake of NAME.csv, the channels in one field.
table() {
    {
        echo '| model, medium, size | bake | L2 % R/G/B | own E % R/G/B | E % | energy ratio R/G/B | p99.9 over mean | truth SE % | relight ms | MB | bake s |'
        echo '|---|---|---|---|---|---|---|---|---|---|---|'
        awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
            {
                slash = $(column["channel"]) == "r" ? "" : "/"
                if (slash == "") { l2 = own = energy = p = se = "" }
                l2 = l2 slash sprintf("%.2f", 100 * $(column["l2"]))
                own = own slash sprintf("%.2f", 100 * $(column["transport_l2"]))
                energy = energy slash sprintf("%.3f", $(column["energy_ratio"]))
                p = p slash sprintf("%.2f", $(column["p999"]))
                se = se slash sprintf("%.2f", 100 * $(column["truth_standard_error"]))
                if ($(column["channel"]) == "b") {
                    bake = $(column["bake"]) == "" ? "default" : "`" $(column["bake"]) "`"
                    printf "| %s, %s, %s | %s | %s | %s | %.1f | %s | %s | %s | %.0f | %.0f | %.1f |\n", $1, $2, $3, bake, l2, own,
                        100 * $(column["irradiance_l2"]), energy, p, se, $(column["relight_ms"]), $(column["asset_bytes"]) / 1e6, $(column["bake_s"])
                }
            }' "$out/$1.csv"
    } > "$out/$1.md"
    cat "$out/$1.md"
}

# column FILE SIZE BAKE NAME: the values of a column in all rows of a size and a bake, ascending.
column() {
    awk -F, -v size="$2" -v bake="$3" -v name="$4" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $3 == size && $(at["bake"]) == bake { print $(at[name]) }' "$1" | sort -g
}

# middle and share FILE... of a sorted column: its median, and its ends.
middle() { awk '{ v[NR] = $1 } END { print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'; }
ends() { awk 'NR == 1 { a = $1 } { b = $1 } END { print a, b }'; }

# summary NAME: a Markdown row for each size and bake, over models, media and channels.
summary() {
    local size bake file=$out/$1.csv
    {
        echo '| size | form | L2 %, median | L2 %, worst | own E %, median | own E %, worst | E %, median | energy ratio | smallest B over mean | MB, median | bake s, median |'
        echo '|---|---|---|---|---|---|---|---|---|---|---|'
        for size in ${SIZES:-10mm 50mm 200mm}; do
            for bake in '' '--form paper'; do
                field() { column "$file" "$size" "$bake" "$1"; }
                echo "$size,${bake:-default},$(field l2 | middle),$(field l2 | ends),$(field transport_l2 | middle),$(
                    field transport_l2 | ends),$(field irradiance_l2 | middle),$(field energy_ratio | ends),$(
                    field minimum | ends),$(field asset_bytes | middle),$(field bake_s | middle)"
            done
        done | awk -F, '{
            split($4, l2, " "); split($6, own, " "); split($8, energy, " "); split($9, least, " ")
            printf "| %s | %s | %.2f | %.2f | %.2f | %.2f | %.1f | %.3f to %.3f | %.3f | %.0f | %.1f |\n", $1,
                $2 == "default" ? $2 : "`" $2 "`", 100 * $3, 100 * l2[2], 100 * $5, 100 * own[2], 100 * $7,
                energy[1], energy[2], least[1], $10 / 1e6, $11 }'
    } > "$out/$1_summary.md"
    cat "$out/$1_summary.md"
}

case $what in
quadrature)
    folders=()
    for model in ${MODELS:-figurine cup candle bunny_mid_75k happy_buddha_100k armadillo_86k}; do
        for medium in ${MEDIA:-marble skimmilk skin1 ketchup}; do
            for size in ${SIZES:-10mm 50mm 200mm}; do
                cell "quadrature/$model,$medium,$size" "$model" "$medium" "$size" --lights "$out/sun.json" --backend cpu \
                    --receivers "${RECEIVERS:-400}" --relight-seconds 1 --bake '' --bake '--form paper'
                folders+=("$out/quadrature/$model,$medium,$size")
            done
        done
    done
    merge grid "${folders[@]}"
    table grid
    summary grid
    ;;
path)
    folders=()
    for model in ${MODELS:-figurine bunny_mid_75k}; do
        for medium in ${MEDIA:-marble skin1}; do
            cell "path/$model,$medium,50mm" "$model" "$medium" 50mm --lights "$out/sky.json" --backend cpu \
                --receivers "${RECEIVERS:-200}" --bake '' --bake '--bssrdf dipole-flux' --bake '--form paper' --reference path \
                --standard-error "${STANDARD_ERROR:-0.005}" --reference-samples 1000000
            folders+=("$out/path/$model,$medium,50mm")
        done
    done
    merge path "${folders[@]}"
    table path
    ;;
settings)
    cell settings figurine marble 50mm --lights "$out/sun.json" --receivers "${RECEIVERS:-1000}" \
        --bake '' --bake '--quality preview' --bake '--quality production' --bake '--form paper' \
        --bake '--threshold 0.01' --bake '--threshold 0.05' --bake '--transfer-vertices 5000 --threshold 0.01' \
        --bake '--transfer-vertices 2500 --threshold 0.05 --atlas 256' --bake '--transfer-vertices 1000 --atlas 256' \
        --bake '--no-local' --bake '--local split --kernel 15'
    ;;
*)
    echo "grid.sh: '$what' is none of quadrature, path, settings" >&2
    exit 1
    ;;
esac
