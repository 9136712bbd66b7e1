# Completion for fish. Install this file in vendor_completions.d. Commands and options come from the
# program's help, names of meshes from the daemon.

function __geodesic_complete
    set -l words (commandline -opc)
    set -l program $words[1]
    set -l connection
    set -e words[1]
    while string match -q -- '-*' $words[1]
        if contains -- $words[1] --url --key
            set -a connection $words[1..2]
            set -e words[1]
        end
        set -e words[1]
    end
    set -l options 's/^ +(-[a-z], )?(--[a-z-]+).*/\2/p'
    if test -z "$words[1]"
        $program --help 2>/dev/null | sed -nE -e $options -e 's/^    ([a-z]+) +(.*)/\1\t\2/p'
    else if string match -q -- '-*' (commandline -ct)
        $program $words[1] --help 2>/dev/null | sed -nE $options
    else if test $words[1] = upload
        __fish_complete_path (commandline -ct)
    else if test (count $words) = 1; and not contains $words[1] list jobs cancel batches batch results wait
        $program $connection list 2>/dev/null | sed 1d | cut -d' ' -f1
    end
end

complete -c geodesic -f -a '(__geodesic_complete)'
