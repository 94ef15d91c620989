# Read by run and service: the kernel of the virtual machine.
# Needs: skip() of who reads it. Sets: folder, kernel, version.
PATH=$PATH:/usr/sbin:/sbin
folder=$PWD/build/vm

# Debian's kernel, which has dummy_hcd: unpacked, not installed.
fetch_kernel() {
  local package
  mkdir -p "$folder/deb"
  if ! compgen -G "$folder/deb/boot/vmlinuz-*" >/dev/null; then
    package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image/ {print $2; exit}')
    [[ -n $package ]] || skip "apt knows no linux-image-amd64; apt-get update"
    (cd "$folder" && apt-get download -q "$package" && dpkg-deb -x "$package"_*.deb deb && rm -f "$package"_*.deb) ||
      skip "the kernel package $package cannot be downloaded"
  fi
  kernel=$(echo "$folder"/deb/boot/vmlinuz-*)
  version=${kernel##*/vmlinuz-}
  [[ -e $folder/deb/lib/modules/$version/modules.dep ]] || depmod -b "$folder/deb" "$version"
}

# modules_to ROOT NAME...: these modules of the kernel and what they need, for modprobe
modules_to() {
  local root=$1 name word file
  shift
  for name in "$@"; do
    modprobe -d "$folder/deb" -S "$version" --show-depends "$name"
  done | while read -r word file _; do
    [[ $word != insmod ]] || install -D -m 644 "$file" "$root/lib/modules/$version/${file##*/modules/"$version"/}"
  done
  cp "$folder/deb/lib/modules/$version"/modules.{order,builtin,builtin.modinfo} "$root/lib/modules/$version/"
  depmod -b "$root" "$version"
}
