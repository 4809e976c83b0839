//! The orders of the machine as the production plan of OPC 40501-1, and the method by which one is proposed.
//! Source: OPC 40501-1 (machine tools) 1.02, 8.7 (production).

use opcua::nodes::MethodBuilder;
use opcua::server::address_space::AddressSpace;
use opcua::types::{
    Argument, DataTypeId, LocalizedText, NodeId, QualifiedName, ReferenceTypeId, VariableTypeId, Variant,
};

use super::adapter_state::ToldOrder;
use super::node_builder::{ChildOf, Namespace, NamespaceIndices, NodeBuilder, TypeNumber, VariableSpec, path_of};

const PLAN: TypeNumber = (Namespace::MachineTool, 30);
const JOB: TypeNumber = (Namespace::MachineTool, 29);
const JOB_STATE: TypeNumber = (Namespace::MachineTool, 28);
const ORDERED_LIST: TypeNumber = (Namespace::Ua, 23_518);
const PROGRAM: TypeNumber = (Namespace::MachineTool, 59);
/// States of a job: their names and nodes, by their numbers.
const STATES: [(&str, TypeNumber); 5] = [
    ("Initializing", (Namespace::MachineTool, 5_015)),
    ("Running", (Namespace::MachineTool, 5_017)),
    ("Ended", (Namespace::MachineTool, 5_014)),
    ("Interrupted", (Namespace::MachineTool, 5_016)),
    ("Aborted", (Namespace::MachineTool, 5_013)),
];
/// Name of the method.
const METHOD: &str = "ProposeOrder";
/// The end of its id.
pub const METHOD_PATH: &str = "/Production/ProductionPlan/ProposeOrder";

/// The plan in the address space.
pub struct ProductionPlan {
    node: NodeId,
    indices: NamespaceIndices,
    /// The method by which an order is proposed.
    pub method: NodeId,
}

impl ProductionPlan {
    /// An empty plan below the production of a machine.
    pub fn create(builder: &mut NodeBuilder<'_>, production: &NodeId) -> Self {
        let node = builder.component(production, "ProductionPlan", PLAN);
        let method = builder.child_id(&node, METHOD);
        let argument = |name: &str, data_type: DataTypeId, is_array: bool| Argument {
            name: name.into(),
            data_type: data_type.into(),
            value_rank: if is_array { 1 } else { -1 },
            array_dimensions: is_array.then(|| vec![0]),
            description: LocalizedText::null(),
        };
        let name = QualifiedName::new(builder.indices.of(Namespace::Own), METHOD);
        let inputs = [
            argument("Order", DataTypeId::UInt32, false),
            argument("Program", DataTypeId::String, false),
            argument("Parts", DataTypeId::UInt32, false),
            argument("Variables", DataTypeId::String, true),
            argument("Values", DataTypeId::Double, true),
        ];
        let outputs = [argument("Proposed", DataTypeId::Boolean, false), argument("Reason", DataTypeId::String, false)];
        MethodBuilder::new(&method, name, METHOD)
            .component_of(node.clone())
            .input_args(builder.space, &builder.child_id(&method, "InputArguments"), &inputs)
            .output_args(builder.space, &builder.child_id(&method, "OutputArguments"), &outputs)
            .executable(true)
            .user_executable(true)
            .insert(builder.space);
        Self { node, indices: builder.indices, method }
    }

    /// Takes the jobs of orders that are gone out, and those of new ones in.
    pub fn change(&self, space: &mut AddressSpace, before: &[ToldOrder], orders: &[ToldOrder]) {
        let has = |list: &[ToldOrder], number: u32| list.iter().any(|order| order.order == number);
        let mut builder = NodeBuilder { space, indices: self.indices, variables: Vec::new() };
        for gone in before.iter().filter(|order| !has(orders, order.order)) {
            let job = builder.child_id(&self.node, &gone.order.to_string());
            remove(builder.space, &job);
        }
        for new in orders.iter().filter(|order| !has(before, order.order)) {
            self.insert_job(&mut builder, new.order);
        }
    }

    fn insert_job(&self, builder: &mut NodeBuilder<'_>, number: u32) {
        use DataTypeId::{Boolean, String, UInt16, UInt32};
        let name = number.to_string();
        let job = builder.object(&self.node, ChildOf::Ordered, (Namespace::Own, &name), JOB);
        let spec = |child, namespace, name, data_type: DataTypeId| VariableSpec::new(child, namespace, name, data_type);
        let property = |name, data_type| spec(ChildOf::Property, Namespace::MachineTool, name, data_type);
        let component = |name, data_type| spec(ChildOf::Component, Namespace::MachineTool, name, data_type);
        let place = || spec(ChildOf::Property, Namespace::Ua, "NumberInList", UInt16);
        builder.fixed(&job, property("Identifier", String), name);
        builder.fixed(&job, place(), Variant::Empty);
        let planned = builder.fixed(&job, component("RunsPlanned", UInt32), Variant::Empty);
        builder.fixed(&planned, property("IsValid", Boolean), true);
        for name in ["RunsCompleted", "PartsCompleted", "PartsGood"] {
            builder.fixed(&job, component(name, UInt32), Variant::Empty);
        }
        let programs = builder.component(&job, "ProductionPrograms", ORDERED_LIST);
        let program = builder.object(&programs, ChildOf::Ordered, (Namespace::Own, "Program"), PROGRAM);
        builder.fixed(&program, property("Name", String), Variant::Empty);
        builder.fixed(&program, place(), 0_u16);
        let state = builder.component(&job, "State", JOB_STATE);
        let current = spec(ChildOf::Component, Namespace::Ua, "CurrentState", DataTypeId::LocalizedText);
        let current = builder.fixed(&state, current.of(VariableTypeId::FiniteStateVariableType), Variant::Empty);
        builder.fixed(&current, spec(ChildOf::Property, Namespace::Ua, "Id", DataTypeId::NodeId), Variant::Empty);
        builder.fixed(&current, spec(ChildOf::Property, Namespace::Ua, "Number", UInt32), Variant::Empty);
        builder.fixed(&job, spec(ChildOf::Property, Namespace::Own, "OrderState", String), Variant::Empty);
        let values = builder.fixed(&job, spec(ChildOf::Property, Namespace::Own, "Values", String), Variant::Empty);
        if let Some(opcua::nodes::NodeType::Variable(values)) = builder.space.find_mut(&values) {
            values.set_value_rank(1);
        }
    }

    /// The values of all jobs.
    #[must_use]
    pub fn values(&self, orders: &[ToldOrder]) -> Vec<(NodeId, Variant)> {
        let (own, plan) = (self.indices.of(Namespace::Own), path_of(&self.node));
        let of_job = |(place, order): (usize, &ToldOrder)| {
            let (state, node) = STATES[state_of(order)];
            let values: Vec<String> = order.values.iter().map(|(name, value)| format!("{name}={value}")).collect();
            let rows = [
                ("NumberInList", Variant::UInt16(place as u16)),
                ("RunsPlanned", Variant::UInt32(order.parts)),
                ("RunsCompleted", Variant::UInt32(order.good.saturating_add(order.bad))),
                ("PartsCompleted", Variant::UInt32(order.good.saturating_add(order.bad))),
                ("PartsGood", Variant::UInt32(order.good)),
                ("ProductionPrograms/Program/Name", Variant::from(order.name.clone())),
                ("State/CurrentState", Variant::from(LocalizedText::new("en", state))),
                ("State/CurrentState/Id", Variant::from(self.indices.node(node))),
                ("State/CurrentState/Number", Variant::UInt32(state_of(order) as u32)),
                ("OrderState", Variant::from(order.state.clone())),
                ("Values", Variant::from(values)),
            ];
            let id = |path| NodeId::new(own, format!("{plan}/{}/{path}", order.order));
            rows.map(|(path, value)| (id(path), value))
        };
        orders.iter().enumerate().flat_map(of_job).collect()
    }
}

/// The state of a job, by its place in [`STATES`].
fn state_of(order: &ToldOrder) -> usize {
    match order.state.as_str() {
        "active" => 1,
        "closed" if order.good >= order.parts => 2,
        "closed" => 4,
        "waiting" if order.good.saturating_add(order.bad) > 0 => 3,
        _ => 0,
    }
}

/// Takes a node out, with all below it.
fn remove(space: &mut AddressSpace, node: &NodeId) {
    use opcua::nodes::DefaultTypeTree;
    use opcua::types::BrowseDirection;
    let types = DefaultTypeTree::new();
    let filter = None::<(ReferenceTypeId, bool)>;
    let children: Vec<NodeId> = space
        .find_references(node, filter, &types, BrowseDirection::Forward)
        .map(|found| found.target_node.clone())
        .filter(|child| child.namespace == node.namespace)
        .collect();
    children.iter().for_each(|child| remove(space, child));
    space.delete(node, true);
}
