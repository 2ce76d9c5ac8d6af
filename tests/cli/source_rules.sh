# source_rules.sh - what every source file keeps to: licence line, first line, length, a name of its own.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
cd "$PARIAN_SOURCE_DIR" || exit 1
sources() { find formats runtime bake assets tests -name '*.c' -o -name '*.h' -o -name '*.cpp'; }

checked=0
for file in $(sources); do
    case $file in
    bake/*) licence=GPL-3.0-or-later ;;
    *) licence=MIT ;;
    esac
    head -20 "$file" | grep -qE "SPDX-License-Identifier: $licence\$" || fail "$file: no line 'SPDX-License-Identifier: $licence'"
    head -1 "$file" | grep -qF "/* $(basename "$file") - " || fail "$file: the first line does not say what lives there"
    lines=$(wc -l < "$file")
    [ "$lines" -le 800 ] || fail "$file: $lines lines, at most 800 were expected"
    awk 'length($0) > 120 { print FILENAME ":" FNR; exit 1 }' "$file" > "$out" || fail "a line of over 120 columns: $(cat "$out")"
    checked=$((checked + 1))
done
[ "$checked" -gt 50 ] || fail "only $checked files were found"
sources | sed 's|.*/||' | sort | uniq -d > "$out"
[ ! -s "$out" ] || fail "names that are not unique: $(tr '\n' ' ' < "$out")"

# A README.md says what a folder's files are: its own, or that of a folder above it below the root.
for folder in $(sources | sed 's|/[^/]*$||' | sort -u); do
    above=$folder
    while [ ! -f "$above/README.md" ]; do
        case $above in
        */*) above=${above%/*} ;;
        *)
            echo "no README.md for $folder"
            missing=1
            break
            ;;
        esac
    done
done
[ -z "${missing:-}" ] || fail "folders without a README"
done_ok
