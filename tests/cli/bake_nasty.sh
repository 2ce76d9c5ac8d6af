# bake_nasty.sh - damaged models: an asset, or one clear line and an exit status, in bounded memory and time.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-bake
need parian-models
expect 0 parian-models --nasty "$work/nasty"

# Sanitizers cost a factor of ten: they get more time, and the small files alone.
limit_s=60
[ "${PARIAN_SANITIZED:-0}" = 0 ] || limit_s=600

# try FILE: 4 GiB of address space (release builds only: sanitizers need more), 60 s; nothing left behind.
try() {
    local file=$1 status
    rm -f "$work/n.parian"
    (
        [ "${PARIAN_SANITIZED:-0}" = 1 ] || ulimit -v 4194304
        exec timeout $limit_s parian-bake "$file" -q --scale 50mm --material marble --transfer-vertices 800 \
            --atlas 256 -o "$work/n.parian"
    ) > "$out" 2> "$err"
    status=$?
    case $status in
    0)
        expect 0 parian-info validate "$work/n.parian"
        ;;
    2 | 3 | 4 | 5)
        one_line "$err"
        [ ! -e "$work/n.parian" ] || fail "$file: status $status, but an asset was left"
        ;;
    *) fail "$file: status $status" ;;
    esac
    ls "$work"/*.tmp* > /dev/null 2>&1 && fail "$file: a temporary file was left"
    printf '%s %s\n' "$status" "$(basename "$file")"
}
for file in "$work"/nasty/*; do try "$file"; done
shared=$PARIAN_SOURCE_DIR/../shared/data/nasty
if [ -d "$shared" ] && [ "${PARIAN_SANITIZED:-0}" = 0 ]; then
    for file in "$shared"/*; do try "$file"; done
fi
done_ok
