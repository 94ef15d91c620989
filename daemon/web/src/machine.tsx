export function Machine({ device }: { device: string }) {
  return <h1>{device}</h1>;
}
