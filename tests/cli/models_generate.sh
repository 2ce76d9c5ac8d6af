# models_generate.sh - the example models: same bytes for any number of threads, the media that were meant.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-models

expect 1 parian-models
one_line "$err"
expect 1 parian-models -o "$work" no_such_model
one_line "$err"
expect 0 parian-models --list
contains "$out" figurine
printf x > "$work/file"
expect 2 parian-models -o "$work/file/below" sphere
one_line "$err"

triangles="--triangles 40000"
for threads in 1 2 7; do
    expect 0 parian-models -q --threads $threads $triangles -o "$work/$threads" leaf sphere slab
    for name in leaf sphere slab; do
        cmp -s "$work/1/$name.glb" "$work/$threads/$name.glb" || fail "$name: $threads threads change the bytes"
    done
done
expect 0 parian-models -q $triangles -o "$work" figurine candle cup leaf

# numbers NAME FILE: the values of a JSON key, a line each.
numbers() {
    tail -c +21 "$2" | head -c 20000 | tr -d '\0' | grep -aoE "\"$1\":(\[[^]]*\]|[^,}]*)" | sed 's/.*://; s/[][]//g'
}
# medium FILE: the extensions' formulas forward: sigma_s' and sigma_a in 1/mm of the scattering material.
medium() {
    awk -v color="$(numbers attenuationColor "$1")" -v distance="$(numbers attenuationDistance "$1")" \
        -v multi="$(numbers multiscatterColorFactor "$1")" -v g="$(numbers scatterAnisotropy "$1")" 'BEGIN {
        split(color, c, ","); split(multi, m, ",")
        for (i = 1; i <= 3; i++) {
            sigma_t = -log(c[i]) / distance
            s = 4.09712 + 4.20863 * m[i] - sqrt(9.59217 + 41.6808 * m[i] + 17.7126 * m[i] * m[i])
            albedo = (1 - s * s) / (1 - g * s * s)
            prime[i] = albedo * sigma_t * (1 - g) / 1000
            absorbed[i] = (1 - albedo) * sigma_t / 1000
        }
        printf "%.6g %.6g %.6g %.6g %.6g %.6g\n", prime[1], prime[2], prime[3], absorbed[1], absorbed[2], absorbed[3]
    }'
}
# Within 0.01 %: nine digits are stored, and the albedo is a difference of numbers near 1 (at most 1e-3 of it is left).
check_medium() {
    local file=$1
    shift
    medium "$file" | awk -v want="$*" '{
        split(want, w, " ")
        for (i = 1; i <= 6; i++) {
            if ($i < w[i] * 0.9999 || $i > w[i] * 1.0001) { print "coefficient " i ": " $i ", expected " w[i]; exit 1 }
        }
    }' > "$err" || fail "$file has another medium"
}
check_medium "$work/figurine.glb" 1.6 1.9 2.3 0.003 0.013 0.045
check_medium "$work/candle.glb" 0.95 1.0 1.1 0.0015 0.007 0.028
check_medium "$work/cup.glb" 1.5 1.6 1.8 0.0040 0.0028 0.0030
check_medium "$work/leaf.glb" 4.2 4.6 5.0 0.42 0.07 0.85

# Real size: the bounds of the body, in metres.
height() { numbers max "$1" | head -1 | cut -d, -f2; }
between() { awk -v x="$2" -v low="$3" -v high="$4" 'BEGIN { exit !(x >= low && x <= high) }' || fail "$1: $2"; }
between "the figurine's height" "$(height "$work/figurine.glb")" 0.049 0.051
between "the candle's height" "$(height "$work/candle.glb")" 0.079 0.081

expect 0 parian-models -q --slide "$work/slide.png" --nasty "$work/nasty"
[ "$(head -c 4 "$work/slide.png" | tail -c 3)" = PNG ] || fail "the slide is no PNG"
while read -r name status; do
    [ -e "$work/nasty/$name" ] || fail "nasty/$name is missing"
done < "$work/nasty/expected.txt"
done_ok
