// design
export default function Design(_: { rest: string }) {
  return <h1>Design</h1>;
}
