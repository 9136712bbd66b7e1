# Completion for bash. Source this file, or install it as `geodesic` in a folder of bash-completion.
# Commands and options come from the program's help, names of meshes from the daemon.

_geodesic_words() { # prints the options and commands of a help text
    sed -nE 's/^ +(-[a-z], )?(--[a-z-]+).*/\2/p; s/^    ([a-z]+) .*/\1/p' <<<"$1"
}

_geodesic() {
    local word=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]} command= i
    for ((i = 1; i < COMP_CWORD; i++)); do
        case ${COMP_WORDS[i]} in
        --url | --key) ((i++)) ;;
        -*) ;;
        *) command=${COMP_WORDS[i]} && break ;;
        esac
    done
    local words
    if [[ -z $command ]]; then
        words=$(_geodesic_words "$("$program" --help 2>/dev/null)")
    elif [[ $word == -* ]]; then
        words=$(_geodesic_words "$("$program" "$command" --help 2>/dev/null)")
    elif [[ $command == upload ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
        return
    elif ((COMP_CWORD == i + 1)) && [[ ! $command =~ ^(list|jobs|cancel|batches|batch|results|wait)$ ]]; then
        words=$("$program" list 2>/dev/null | sed 1d | cut -d' ' -f1)
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}

complete -F _geodesic geodesic
