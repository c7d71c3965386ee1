// SPDX-License-Identifier: GPL-3.0-or-later
import { createApp, defineComponent, nextTick, onBeforeUnmount, onMounted, reactive, ref } from 'vue/dist/vue.esm-bundler.js';

const Head = defineComponent({
  props: ['name', 'greeting', 'head'],
  template: `<talking-head ref="element" :data-name="name" v-bind="head" @ready="note('ready')"
    @word="note($event.detail.text)" @end="note($event.detail.reason)"></talking-head>`,
  setup(props) {
    const element = ref(null);
    onMounted(() => {
      window.ends = [];
      if (props.greeting) element.value.speak(props.greeting, { lang: 'it' }).then((end) => window.ends.push(end.reason));
    });
    onBeforeUnmount(() => element.value.stop?.());
    return { element, note: (what) => window.note(props.name, what) };
  },
});

let app = null;
const state = reactive({ names: [], greeting: undefined, head: {} });
window.render = ({ names, greeting, ...head }) => {
  Object.assign(state, { names, greeting, head });
  if (!app) {
    app = createApp({
      components: { Head },
      setup: () => ({ state }),
      template: '<Head v-for="name in state.names" :key="name" :name="name" :greeting="state.greeting" :head="state.head" />',
    });
    app.config.compilerOptions.isCustomElement = (tag) => tag.includes('-');
    app.mount('#app');
  }
  return nextTick();
};
window.unmount = () => {
  app.unmount();
  app = null;
};
