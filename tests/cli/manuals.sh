# manuals.sh - manual pages and completion: from the tables of --help, clean for man and mandoc, tried in the shells.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
manuals=$PARIAN_BINARY_DIR/manuals
[ -d "$manuals/man1" ] || { echo "skipped: the manual pages are not built"; exit 77; }

# Every page is clean, deterministic, and names every option of --help.
pages=0
for page in "$manuals"/man1/*.1; do
    if command -v mandoc > /dev/null; then
        mandoc -T lint -W warning "$page" 2>&1 | grep -v 'missing date' > "$out" && fail "mandoc: $(head -3 "$out")"
    fi
    if command -v man > /dev/null && command -v groff > /dev/null; then
        LC_ALL=C.UTF-8 man --warnings -l "$page" 2> "$err" > "$out" || fail "man cannot read $page"
        [ ! -s "$err" ] || fail "man warns of $page"
    fi
    pages=$((pages + 1))
done
[ "$pages" -ge 6 ] || fail "only $pages pages"
for tool in parian-bake parian-info parian-view; do
    command -v $tool > /dev/null || continue
    expect 0 $tool --help=man
    cmp -s "$out" "$manuals/man1/$tool.1" || fail "$tool --help=man is not the page that was built"
    tr -d '\\' < "$out" > "$work/page"
    expect 0 $tool --help
    grep -oE '^  -[-a-zA-Z]+' "$out" | while read -r option; do
        grep -qF -- "fB$option" "$work/page" || fail "the page of $tool lacks $option"
    done || exit 1
done
expect 0 parian-info validate --help=man
contains "$out" ".TH PARIAN\-INFO\-VALIDATE 1"
expect 1 parian-info --help=html
one_line "$err"

# bash: what is offered at the end of the words given. reply TOOL words...
reply() {
    bash -c '
        compopt() { :; }
        . "$1/bash/$2" || exit 1
        shift
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        "_${1//-/_}"
        printf "%s\n" "${COMPREPLY[@]}"' completion "$manuals" "$@" > "$out" 2> "$err" || fail "completion of $*"
    [ ! -s "$err" ] || fail "completion of $*"
}
reply_is() {
    local want=$1
    shift
    reply "$@"
    [ "$(tr '\n' ' ' < "$out" | sed 's/ *$//')" = "$want" ] || fail "after '$*': '$want' was expected: $(cat "$out")"
}
cd "$work" || exit 1
mkdir 'some folder' && : > 'some file.parian'
reply_is "auto bar json none" parian-info --progress ""
reply_is "json" parian-info --progress = j
reply_is "auto bar json none" parian-info --progress =
reply_is "--tolerance" parian-info compare a b --to
reply_is "" parian-info chunks a --to
reply_is "validate" parian-info val
reply_is "some file.parian some folder" parian-info validate some
reply_is "" parian-info --threads ""
if command -v parian-bake > /dev/null; then
    reply_is "preview production" parian-bake x.glb --quality pr
    reply_is "pbd path planar" parian-bake reference --model p
    reply_is "some folder" parian-bake x.glb --dump some
    reply_is "some file.parian some folder" parian-bake x.glb -o some
fi
for shell in zsh fish; do
    command -v $shell > /dev/null || continue
    for file in "$manuals/$shell"/*; do expect 0 $shell -n "$file"; done
done
if command -v fish > /dev/null; then
    export HOME=$work
    expect 0 fish -c "source $manuals/fish/parian-info.fish; complete -C 'parian-info --progress '"
    contains "$out" json
    expect 0 fish -c "source $manuals/fish/parian-info.fish; complete -C 'parian-info compare a --'"
    contains "$out" --tolerance
    expect 0 fish -c "source $manuals/fish/parian-info.fish; complete -C 'parian-info chunks a --'"
    lacks "$out" --tolerance
fi
done_ok
