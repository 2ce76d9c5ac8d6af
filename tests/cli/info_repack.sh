# info_repack.sh - parian-info repack: the same arrays, what is unknown kept, what cannot be done refused.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-info
golden=$PARIAN_SOURCE_DIR/tests/golden
asset=$work/tiny.parian
cp "$golden/tiny_1_0.parian" "$asset" && chmod u+w "$asset"
size() { stat -c %s "$1"; }
no_leftovers() { ! ls -A "$work" "$work/new" 2> /dev/null | grep -q '\.tmp$' || fail "a temporary file was left"; }

# Every level and codec: the same arrays, a valid file.
for options in "" "--level 1" "--level 19" "--codec raw" "--codec keep" "--codec zstd" "--codec shuffle --level 3" "--codec delta"; do
    # shellcheck disable=SC2086
    expect 0 parian-info repack "$asset" -o "$work/out.parian" $options
    expect 0 parian-info compare "$asset" "$work/out.parian"
    expect 0 parian-info validate "$work/out.parian"
done
expect 0 parian-info repack "$asset" -o "$work/small.parian" --level 19
expect 0 parian-info chunks "$work/small.parian"
contains "$out" "shuffle+zstd"
expect 0 parian-info repack "$asset" -o "$work/raw.parian" --codec raw
[ "$(size "$work/raw.parian")" -gt "$(size "$work/small.parian")" ] || fail "raw is no larger than level 19"
expect 0 parian-info chunks "$work/raw.parian"
lacks "$out" "zstd"

# The same bytes for any number of threads, and whatever codecs came in.
for threads in 1 2 7; do
    expect 0 parian-info repack "$work/raw.parian" --threads $threads --level 19 -o "$work/t$threads.parian"
    cmp -s "$work/t$threads.parian" "$work/small.parian" || fail "other bytes with $threads threads"
done

# Onto itself, through a link, into a new folder; --json and -q.
cp "$asset" "$work/self.parian"
expect 0 parian-info repack "$work/self.parian" -o "$work/self.parian" --level 19
cmp -s "$work/self.parian" "$work/small.parian" || fail "repacking a file onto itself gives other bytes"
ln "$work/raw.parian" "$work/link.parian"
expect 0 parian-info repack "$work/raw.parian" -o "$work/link.parian" --level 19
cmp -s "$work/link.parian" "$work/small.parian" || fail "repacking onto another name of the file"
expect 0 parian-info validate "$work/raw.parian"
expect 0 parian-info repack "$asset" -o "$work/new/folder/out.parian" --json
contains "$out" '"output_bytes"'
expect 0 parian-info repack -q "$asset" -o "$work/out.parian"
[ ! -s "$out" ] || fail "-q prints"

# What is unknown and optional stays byte for byte, with the version and the flags that it came with.
later=$golden/later_optional_1_9.parian
expect 0 parian-info repack "$later" -o "$work/later.parian" --level 19
contains "$out" "2 of them unknown"
expect 0 parian-info compare "$later" "$work/later.parian"
expect 0 parian-info info "$work/later.parian"
contains "$out" "format 1.9"
cmp -s <(head -c 12 "$later") <(head -c 12 "$work/later.parian") || fail "another version"
entry() { grep -obaF "$2" "$1" | head -1 | cut -d: -f1; }
for name in body.from_the_future scene.counts; do
    a=$(entry "$later" $name) b=$(entry "$work/later.parian" $name)
    cmp -s <(tail -c +$((a + 1)) "$later" | head -c 88) <(tail -c +$((b + 1)) "$work/later.parian" | head -c 88) ||
        fail "the entry of $name differs"
done

# What cannot be done: one line, and what was there stays.
cp "$asset" "$work/kept.parian"
refuse() {
    local want=$1 text=$2
    shift 2
    expect "$want" parian-info -q repack "$@" -o "$work/kept.parian"
    one_line "$err"
    contains "$err" "$text"
    cmp -s "$asset" "$work/kept.parian" || fail "a failed repack changed its target"
    no_leftovers
}
refuse 5 "body.grid_of_media" "$golden/later_required_1_9.parian"
refuse 5 "rule 113" "$golden/later_codec_1_9.parian"
refuse 5 "rule 104" "$golden/later_major_2_0.parian"
cp "$asset" "$work/flip.parian"
printf '\x5a' | dd of="$work/flip.parian" bs=1 seek=4000 conv=notrunc 2> /dev/null
refuse 3 "rule 1" "$work/flip.parian"
refuse 2 "missing.parian" "$work/missing.parian"
expect 1 parian-info repack "$asset"
expect 1 parian-info repack "$asset" -o -
expect 1 parian-info repack "$asset" "$asset" -o "$work/two.parian"
expect 1 parian-info repack "$asset" -o "$work/two.parian" --level 20
expect 1 parian-info repack "$asset" -o "$work/two.parian" --codec lzma
for target in /dev/full "$work" "$work/kept.parian/below"; do
    expect 2 parian-info -q repack "$asset" -o "$target"
    one_line "$err"
done
(
    ulimit -f 8 # in kilobytes: the disk is full in the middle of the file
    trap '' XFSZ
    expect 2 parian-info -q repack "$asset" --codec raw -o "$work/kept.parian"
) || exit 1
cmp -s "$asset" "$work/kept.parian" || fail "a full disk changed the target"
no_leftovers
done_ok
