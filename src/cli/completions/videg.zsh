#compdef videg
# Completions of videg for zsh: source <(videg completions zsh)
_videg() {
    local -a whole open
    local candidate
    for candidate in "${(@f)$(VIDEG_COMPLETE=zsh _CLAP_IFS=$'\n' _CLAP_COMPLETE_INDEX=$((CURRENT - 1)) \
        videg -- "${(@)words[1,CURRENT - 1]}" "$PREFIX" 2>/dev/null)}"; do
        case "${candidate%%:*}" in
            '') ;;
            # The word goes on behind these.
            *[=/]) open+=("$candidate") ;;
            *) whole+=("$candidate") ;;
        esac
    done
    (( $#open )) && _describe -V value open -S ''
    (( $#whole )) && _describe -V value whole
}
if [ "$funcstack[1]" = "_videg" ]; then
    _videg "$@"
else
    compdef _videg videg
fi
