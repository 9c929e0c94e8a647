# What zsh offers at the end of a line: complete.zsh FOLDER-OF-SCRIPTS LINE. A real zsh at a terminal of its own, with its
# completion system and a Tab; prints the candidates, one a line.
zmodload zsh/zpty
folder=$1 line=$2
answers=$(mktemp -u)
mkfifo $answers
TRAPEXIT() { rm -f $answers }
zpty shell zsh -f -i
zpty -w shell "fpath=($folder \$fpath); autoload -U compinit; compinit -u -D
compadd() {
  local -a offered
  (( \${@[(I)-[ADO]*]} )) || { builtin compadd -O offered \"\$@\"; print -rl -- \$offered >&9 }
  builtin compadd \"\$@\"
}
offer() { exec 9>$answers; _main_complete; print -r -- END >&9; exec 9>&- }
zle -C offer complete-word offer
bindkey '^I' offer"
zpty -w -n shell "$line"$'\t'
while read -r -t 20 word; do
  [[ $word == END ]] && break
  [[ -n $word ]] && print -r -- $word
done < $answers
zpty -d shell
