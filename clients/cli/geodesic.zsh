#compdef geodesic
# Completion for zsh. Install this file as _geodesic in a folder of $fpath. Commands and options come
# from the program's help, names of meshes from the daemon.

local program=$words[1] expression='s/^ +(-[a-z], )?(--[a-z-]+).*/\2/p' i=2
local -a connection
while ((i < CURRENT)) && [[ $words[i] == -* ]]; do
    if [[ $words[i] == --(url|key) ]]; then
        connection+=($words[i,i+1])
        ((i++))
    fi
    ((i++))
done
if ((i >= CURRENT)); then
    compadd -- $($program --help 2>/dev/null | sed -nE -e $expression -e 's/^    ([a-z]+) .*/\1/p')
elif [[ $words[CURRENT] == -* ]]; then
    compadd -- $($program $words[i] --help 2>/dev/null | sed -nE $expression)
elif [[ $words[i] == upload ]]; then
    _files
elif ((CURRENT == i + 1)) && [[ $words[i] != (list|jobs|cancel|batches|batch|results|wait) ]]; then
    compadd -- $($program $connection list 2>/dev/null | sed 1d | cut -d' ' -f1)
fi
