# What fish offers at the end of a line: complete.fish FOLDER-OF-SCRIPTS LINE. Prints the candidates, one a line.
source $argv[1]/(string split -f 1 ' ' -- $argv[2]).fish
complete -C $argv[2] | string replace -r '\t.*' ''
