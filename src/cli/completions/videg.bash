# Completions of videg for bash: eval "$(videg completions bash)"
_videg() {
    local line=${COMP_LINE:0:COMP_POINT} words=() i rest word before candidate
    # Bash divides words at = and :, too. What stands there without a space is one word, up to the cursor.
    for ((i = 0; i <= COMP_CWORD; i++)); do
        rest=${line#"${line%%[![:space:]]*}"}
        word=${COMP_WORDS[i]}
        ((i == COMP_CWORD)) && word=$rest
        if ((i > 0)) && [[ $rest == "$line" ]]; then
            words[${#words[@]} - 1]+=$word
        else
            words+=("$word")
        fi
        line=${rest#"$word"}
    done
    # Bash replaces $2 alone, so candidates go without what stands before it.
    before=${words[${#words[@]} - 1]%"$2"}
    before=${before//[\"\']/}
    words[${#words[@]} - 1]=$before$2
    COMPREPLY=()
    while IFS= read -r candidate || [[ -n $candidate ]]; do
        candidate=${candidate#"$before"}
        # A name of a file may mean something to the shell; within quotes it is as it is.
        [[ $2 != [\"\']* && $candidate == *[^[:alnum:]_.,:=/+@%~-]* ]] && printf -v candidate %q "$candidate"
        COMPREPLY+=("$candidate")
    done < <(VIDEG_COMPLETE=bash _CLAP_IFS=$'\n' _CLAP_COMPLETE_INDEX=$((${#words[@]} - 1)) \
        videg -- "${words[@]}" 2>/dev/null)
    # The word goes on behind these.
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=/] ]] && compopt -o nospace 2>/dev/null
    return 0
}
complete -o bashdefault -F _videg videg
