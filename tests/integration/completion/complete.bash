# What bash offers at the end of a line: complete.bash FOLDER-OF-SCRIPTS LINE. Programs' scripts are loaded as
# bash-completion does it; words are cut at spaces and '=', as readline does. Prints the candidates, one a line.
line=$2
read -r -a COMP_WORDS <<<"${line//=/ = }"
[[ $line == *[' ='] ]] && COMP_WORDS+=('')
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
COMP_LINE=$line
COMP_POINT=${#line}
source "$1/${COMP_WORDS[0]}"
compopt() { :; } # is of readline alone
how=($(complete -p "${COMP_WORDS[0]}"))
"${how[2]}"
printf '%s\n' "${COMPREPLY[@]}"
