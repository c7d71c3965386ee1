// SPDX-License-Identifier: MIT
// Turns the decoders that three.js ships as plain scripts into modules: Draco's, and Basis Universal's, which would create
// functions from text. A strict content security policy forbids that, so this does the same with closures. An esbuild plugin.
import { readFileSync } from 'node:fs';

/** Calls that embind would write out as text (emscripten's embind.js), as one function that does it. */
const INVOKE = `((...given) => {
  const most = argTypes.length - 2;
  return function (...own) {
    if (own.length !== most) throwBindingError('function ' + humanName + ' called with ' + own.length + ' arguments, expected ' + most);
    const destructors = needsDestructorStack ? [] : null;
    const wired = isClassMethodFunc ? [argTypes[1].toWireType(destructors, this)] : [];
    own.forEach((value, i) => wired.push(argTypes[i + 2].toWireType(destructors, value)));
    const result = cppInvokerFunc(cppTargetFunc, ...wired);
    if (destructors) runDestructors(destructors);
    else
      argTypes.slice(isClassMethodFunc ? 1 : 2).forEach((type, i) => {
        if (type.destructorFunction !== null) type.destructorFunction(wired[i]);
      });
    return returns ? argTypes[0].fromWireType(result) : undefined;
  };
})`;
const CALL = `((retType) => (obj, func, destructorsRef, from) => {
  let offset = 0;
  const values = types.map((type) => {
    const value = type.readValueFromPointer(from + offset);
    offset += type.argPackAdvance;
    return value;
  });
  const result = kind === 1 ? new func(...values) : func.call(...(kind === 0 ? [obj] : []), ...values);
  return retType.isVoid ? undefined : emval_returnValue(retType, destructorsRef, result);
})`;

const SCRIPTS = {
  'draco_wasm_wrapper.js': { name: 'DracoDecoderModule', instead: [] },
  'basis_transcoder.js': { name: 'BASIS', instead: [['newFunc(Function,args)', INVOKE], ['newFunc(Function,params)', CALL]] },
};

export const decoders = {
  name: 'decoders',
  setup({ onLoad }) {
    onLoad({ filter: /three[/\\]examples.*[/\\](draco_wasm_wrapper|basis_transcoder)\.js$/ }, ({ path: file }) => {
      const { name, instead } = SCRIPTS[file.replace(/^.*[/\\]/, '')];
      let contents = readFileSync(file, 'utf8');
      for (const [text, own] of instead) {
        if (contents.split(text).length !== 2) throw new Error(`${file}: "${text}" is not there once`);
        contents = contents.replace(text, () => own);
      }
      return { contents: `${contents}\nexport default ${name};\n` };
    });
  },
};
