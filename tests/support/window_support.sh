# window_support.sh - sourced by what drives parian-view's window: a display of its own, mouse, keys, screenshots.
# Needs cli_support.sh. Variables: pictures (folder of what the window saves), log (what it said).
need Xvfb
need xdotool
pictures=$work/pictures
log=$work/window.log
mkdir -p "$pictures"

# A free display, without races: Xvfb chooses its number.
start_display() {
    Xvfb -displayfd 3 -screen 0 "$1x24" -nolisten tcp 3> "$work/display" 2> /dev/null &
    display_pid=$!
    trap 'kill "$view_pid" "$display_pid" 2> /dev/null; wait 2> /dev/null; rm -rf "$work"' EXIT
    for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
    [ -s "$work/display" ] || { echo "skipped: Xvfb does not start"; exit 77; }
    export DISPLAY=:$(cat "$work/display")
    unset WAYLAND_DISPLAY
}
view_pid=

# wait_for TEXT [seconds]: until the window's log holds it that many times more than before.
wait_for() {
    local tries=$((${2:-60} * 10))
    while ! grep -qF -- "$1" "$log"; do
        kill -0 "$view_pid" 2> /dev/null || fail "the window is gone: $(cat "$log")"
        tries=$((tries - 1))
        [ $tries -gt 0 ] || fail "no '$1' in $(cat "$log")"
        sleep 0.1
    done
}
# start_window ARGUMENTS: returns when the first picture stands.
start_window() {
    (cd "$pictures" && exec parian-view "$@" -v) > "$log" 2>&1 &
    view_pid=$!
    if ! kill -0 $view_pid 2> /dev/null || { sleep 0.5; grep -q "gives no OpenGL" "$log"; }; then
        echo "skipped: $(cat "$log")"
        exit 77
    fi
    wait_for "first picture after"
}
# shoot NAME: the window as it is seen, panel included, as $pictures/NAME.png.
saved=0
shoot() {
    local file
    saved=$((saved + 1))
    file=$(printf 'parian-view-%03d.png' $saved)
    sleep 0.4 # a coarse picture is refined
    xdotool key shift+p
    wait_for "wrote $file"
    mv "$pictures/$file" "$pictures/$1.png"
}
key() { xdotool key "$@"; sleep 0.2; }
# drag BUTTON X Y X Y ...: from place to place, with the button held.
drag() {
    local button=$1
    shift
    xdotool mousemove "$1" "$2"; sleep 0.2
    xdotool mousedown "$button"; sleep 0.2
    shift 2
    while [ $# -gt 1 ]; do
        xdotool mousemove "$1" "$2"; sleep 0.2
        shift 2
    done
    xdotool mouseup "$button"; sleep 0.2
}
# Close it; the log then says how often each pass ran.
stop_window() {
    xdotool key Escape
    wait "$view_pid" || fail "the window ended with $?: $(cat "$log")"
    view_pid=
}
