# Made by docs/generate.py from the help of the programs.
# bash: source it, or install it as bash-completion's springtower.

# Names of a list, the last of it to be completed.
_springtower_listed() {
  local before=""
  [[ $current == *,* ]] && before=${current%,*},
  mapfile -t COMPREPLY < <(compgen -P "$before" -W "$1" -- "${current##*,}")
}

# A scene by its name, or a file. A colon ends a word of bash, so what comes before it is left out of the answer.
_springtower_scene() {
  local before=""
  [[ $current == *:* ]] && before=${current%"${current##*:}"}
  mapfile -t COMPREPLY < <(compgen -W "tower: uneven: swaying: heavy: holes collapse: falling-rows: towers: touching: shot: sleeper wall: pyramid: bricks: cubes: pile: heap: rain: askew: dropped-flat dropped-on-corner slope sliding spinning thrown thin-wall" -- "$current" || :; compgen -f -X "!*.toml" -- "$current" || :; compgen -d -S / -- "$current" || :)
  [[ -z $before ]] || COMPREPLY=("${COMPREPLY[@]#"$before"}")
  compopt -o nospace 2>/dev/null || true
}

# The word before the cursor with the colons that bash has split off.
_springtower_words() {
  current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local at=$COMP_CWORD
  if [[ $current == : ]]; then
    current=$previous: previous=${COMP_WORDS[at - 2]}
  elif [[ $previous == : ]]; then
    current=${COMP_WORDS[at - 2]}:$current previous=${COMP_WORDS[at - 3]}
  fi
}

_springtower() {
  local current previous command
  _springtower_words
  command=${COMP_WORDS[1]}
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "run verdict profile statics chart validate settings scenes -h --help --version --help-all" -- "$current")
    return
  fi
  case $command in
    run)
      case $previous in
        --seconds) COMPREPLY=(); return ;;
        --method) _springtower_listed "implicit bdf2 implicit-euler implicit-eigen bdf2-eigen semi-implicit-euler midpoint runge-kutta-4 report legacy-2003 rigid-pgs rigid-lcp xpbd auto"; return ;;
        --inertia) _springtower_listed "cuboid lumped"; return ;;
        --tolerance) COMPREPLY=(); return ;;
        --substeps) COMPREPLY=(); return ;;
        --iterations) COMPREPLY=(); return ;;
        --threads) COMPREPLY=(); return ;;
        --prepare-budget) COMPREPLY=(); return ;;
        --heights-sigma) COMPREPLY=(); return ;;
        --mass-sigma) COMPREPLY=(); return ;;
        --seed) COMPREPLY=(); return ;;
        --start-gap) COMPREPLY=(); return ;;
        --gravity-tilt) COMPREPLY=(); return ;;
        --gravity-direction) COMPREPLY=(); return ;;
        --gravity-sway) COMPREPLY=(); return ;;
        --report) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --poses) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --poses-every) COMPREPLY=(); return ;;
        --picture) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --save) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --resume) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --seconds --method --inertia --tolerance --substeps --iterations --no-sleep --allow-unstable --threads --prepare-budget --heights-sigma --mass-sigma --seed --start-gap --gravity-tilt --gravity-direction --gravity-sway --report --forces --poses --poses-every --picture --save --resume --force-unstable" -- "$current")
      else
        _springtower_scene
      fi
      ;;
    verdict)
      case $previous in
        --seconds) COMPREPLY=(); return ;;
        --method) _springtower_listed "implicit bdf2 implicit-euler implicit-eigen bdf2-eigen semi-implicit-euler midpoint runge-kutta-4 report legacy-2003 rigid-pgs rigid-lcp xpbd auto"; return ;;
        --inertia) _springtower_listed "cuboid lumped"; return ;;
        --tolerance) COMPREPLY=(); return ;;
        --substeps) COMPREPLY=(); return ;;
        --iterations) COMPREPLY=(); return ;;
        --threads) COMPREPLY=(); return ;;
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --seconds --method --inertia --tolerance --substeps --iterations --no-sleep --allow-unstable --threads --check --keep-going --force-unstable" -- "$current")
      else
        mapfile -t COMPREPLY < <(compgen -f -- "$current")
      fi
      ;;
    profile)
      case $previous in
        --rows) COMPREPLY=(); return ;;
        --scenes) _springtower_listed "rest sway heights pull pull-sleep game collapse asleep towers pile walls pyramids starts topple hit heaps piles rain"; return ;;
        --methods) _springtower_listed "implicit bdf2 implicit-euler implicit-eigen bdf2-eigen semi-implicit-euler midpoint runge-kutta-4 report legacy-2003 rigid-pgs rigid-lcp xpbd auto"; return ;;
        --tolerances) COMPREPLY=(); return ;;
        --threads) COMPREPLY=(); return ;;
        --towers) COMPREPLY=(); return ;;
        --stacks) COMPREPLY=(); return ;;
        --falls) COMPREPLY=(); return ;;
        --inertia) _springtower_listed "cuboid lumped"; return ;;
        --samples) COMPREPLY=(); return ;;
        --frames) COMPREPLY=(); return ;;
        --settle) COMPREPLY=(); return ;;
        --prepare-limit) COMPREPLY=(); return ;;
        --sample-limit) COMPREPLY=(); return ;;
        --peer-limit) COMPREPLY=(); return ;;
        --out) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
        --trace) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --from) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --rows --scenes --methods --tolerances --threads --towers --stacks --falls --inertia --samples --frames --settle --prepare-limit --sample-limit --peer-limit --full --quick --no-resume --out --trace --from --fresh" -- "$current")
      fi
      ;;
    statics)
      case $previous in
        --mu) COMPREPLY=(); return ;;
        --heights-sigma) COMPREPLY=(); return ;;
        --mass-sigma) COMPREPLY=(); return ;;
        --seed) COMPREPLY=(); return ;;
        --gravity-tilt) COMPREPLY=(); return ;;
        --gravity-direction) COMPREPLY=(); return ;;
        --remove) COMPREPLY=(); return ;;
        --pull) COMPREPLY=(); return ;;
        --report) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --threads) COMPREPLY=(); return ;;
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --mu --heights-sigma --mass-sigma --seed --gravity-tilt --gravity-direction --remove --pull --contacts --no-removals --report --check --keep-going --threads" -- "$current")
      else
        _springtower_scene
      fi
      ;;
    chart)
      case $previous in
        --scenes) _springtower_listed "uniform heights pull drop collapse spin heavy-light wall pyramid shot heap-200 rain-200 pile-3 holes lean tall slide heap thrown"; return ;;
        --methods) _springtower_listed "implicit bdf2 implicit-euler implicit-eigen bdf2-eigen semi-implicit-euler midpoint runge-kutta-4 report legacy-2003 rigid-pgs rigid-lcp xpbd auto"; return ;;
        --rows) COMPREPLY=(); return ;;
        --seconds) COMPREPLY=(); return ;;
        --case-limit) COMPREPLY=(); return ;;
        --samples) COMPREPLY=(); return ;;
        --peers) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --out) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --scenes --methods --rows --seconds --case-limit --samples --peers --out --quick --no-time-limit --auto --no-resume --maps --long --fresh" -- "$current")
      fi
      ;;
    validate)
      case $previous in
        --out) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
        --only) _springtower_listed "verdicts forces pull tilt loose scale sleep moves"; return ;;
        --oracle) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
        --scenes) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
        --threads) COMPREPLY=(); return ;;
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --out --full --only --oracle --scenes --check --no-resume --threads --long --fresh" -- "$current")
      fi
      ;;
    settings)
      case $previous in
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all --all --json" -- "$current")
      fi
      ;;
    scenes)
      case $previous in
      esac
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help --help-all" -- "$current")
      fi
      ;;
  esac
}

_springtower_viewer() {
  local current previous
  _springtower_words
      case $previous in
        --scene) _springtower_scene; return ;;
        --players) COMPREPLY=(); return ;;
        --heights-sigma) COMPREPLY=(); return ;;
        --mass-sigma) COMPREPLY=(); return ;;
        --start-gap) COMPREPLY=(); return ;;
        --seed) COMPREPLY=(); return ;;
        --method) _springtower_listed "implicit bdf2 implicit-euler implicit-eigen bdf2-eigen semi-implicit-euler midpoint runge-kutta-4 report legacy-2003 rigid-pgs rigid-lcp xpbd auto"; return ;;
        --tolerance) COMPREPLY=(); return ;;
        --friction) COMPREPLY=(); return ;;
        --threads) COMPREPLY=(); return ;;
        --grip) COMPREPLY=(); return ;;
        --overlay) _springtower_listed "wood load strain asleep islands hints"; return ;;
        --mode) COMPREPLY=(); return ;;
        --scale) COMPREPLY=(); return ;;
        --size) COMPREPLY=(); return ;;
        --camera) COMPREPLY=(); return ;;
        --frames) COMPREPLY=(); return ;;
        --png-every) COMPREPLY=(); return ;;
        --png) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
        --mouse) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --video) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --record) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --replay) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --report) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --poses) mapfile -t COMPREPLY < <(compgen -f -- "$current"); return ;;
        --out) mapfile -t COMPREPLY < <(compgen -d -- "$current"); return ;;
      esac
  mapfile -t COMPREPLY < <(compgen -W "-h --help --version --scene --players --heights-sigma --mass-sigma --start-gap --seed --method --tolerance --friction --no-sleep --threads --grip --overlay --arrows --paused --mode --scale --no-panels --size --camera --headless --frames --png-every --png --mouse --video --record --replay --report --poses --out" -- "$current")
}

complete -F _springtower springtower
complete -F _springtower_viewer springtower-viewer
